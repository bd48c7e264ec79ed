# SPDX-License-Identifier: BSD-3-Clause
# A recipe of Conan 2. From the checkout's root: conan create packaging/conan -s compiler.cppstd=20 --build=missing
# ../../scripts/conan.sh runs it with what Debian has installed in place of the packages that it requires.
import os

from conan import ConanFile
from conan.tools.build import check_min_cppstd
from conan.tools.cmake import CMake, CMakeDeps, CMakeToolchain, cmake_layout
from conan.tools.files import copy, rmdir


class HfremeshConan(ConanFile):
    name = "hfremesh"
    version = "0.1.0"
    license = "BSD-3-Clause"
    description = "Repairs and improves tetrahedral meshes in place, in parallel"
    package_type = "library"
    settings = "os", "compiler", "build_type", "arch"
    options = {"shared": [True, False], "fPIC": [True, False], "surface": [True, False]}
    default_options = {"shared": False, "fPIC": True, "surface": True}
    implements = ["auto_shared_fpic"]

    def export_sources(self):
        root = os.path.join(self.recipe_folder, "..", "..")
        for pattern in ("CMakeLists.txt", "LICENSE", "cmake/*", "kernels/*", "src/*"):
            copy(self, pattern, root, self.export_sources_folder)

    def requirements(self):
        self.requires("fmt/[>=9]")
        self.requires("tinyxml2/[>=9]")
        self.requires("zlib/[>=1.2.11 <2]")
        if self.options.surface:
            self.requires("eigen/[>=3.3]")
            self.requires("openmesh/[>=9]")

    def validate(self):
        check_min_cppstd(self, 20)

    def layout(self):
        cmake_layout(self)

    def generate(self):
        CMakeDeps(self).generate()
        toolchain = CMakeToolchain(self)
        toolchain.cache_variables["HFR_SURFACE"] = bool(self.options.surface)
        for off in ("HFR_TESTS", "HFR_TOOL", "HFR_C_API", "HFR_OPENCL"):
            toolchain.cache_variables[off] = False
        toolchain.generate()

    def build(self):
        cmake = CMake(self)
        cmake.configure()
        cmake.build()

    def package(self):
        CMake(self).install()
        copy(self, "LICENSE", self.source_folder, os.path.join(self.package_folder, "licenses"))
        # What users of Conan find instead is made of package_info().
        rmdir(self, os.path.join(self.package_folder, "lib", "cmake"))
        rmdir(self, os.path.join(self.package_folder, "lib", "pkgconfig"))
        rmdir(self, os.path.join(self.package_folder, "share"))

    def package_info(self):
        self.cpp_info.libs = ["hfremesh"]
        self.cpp_info.cxxflags = ["-ffp-contract=off"]
        self.cpp_info.set_property("cmake_file_name", "hfremesh")
        self.cpp_info.set_property("cmake_target_name", "hfremesh::hfremesh")
        if not self.options.shared:
            # Threads of OpenMP are in the objects of a static library; the compiler knows where its own lie.
            self.cpp_info.exelinkflags = ["-fopenmp"]
            self.cpp_info.sharedlinkflags = ["-fopenmp"]
