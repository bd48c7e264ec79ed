# SPDX-License-Identifier: BSD-3-Clause
# Not run yet. The checksum is that of no release.
from spack.package import *


class Hfremesh(CMakePackage):
    """Repairs and improves tetrahedral meshes in place, in parallel."""

    license("BSD-3-Clause")
    version("0.1.0", sha256="0" * 64)

    variant("shared", default=True, description="A shared library")
    variant("surface", default=True, description="Operators on the surface")
    variant("tool", default=True, description="The command hfremesh")

    depends_on("cxx", type="build")
    depends_on("cmake@3.25:", type="build")
    depends_on("fmt")
    depends_on("tinyxml2")
    depends_on("zlib-api")
    depends_on("openmesh", when="+surface")
    depends_on("eigen@3.3:", when="+surface")
    depends_on("cli11", when="+tool")
    depends_on("nlohmann-json", when="+tool")
    depends_on("libpng", when="+tool")

    def cmake_args(self):
        return [
            self.define_from_variant("BUILD_SHARED_LIBS", "shared"),
            self.define_from_variant("HFR_SURFACE", "surface"),
            self.define_from_variant("HFR_TOOL", "tool"),
            self.define("HFR_TESTS", False),
        ]
