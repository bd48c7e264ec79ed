# SPDX-License-Identifier: BSD-3-Clause
# Not run yet. From the checkout's root: conan create packaging/conan --build=missing
import os

from conan import ConanFile
from conan.tools.cmake import CMake, CMakeDeps, CMakeToolchain
from conan.tools.files import copy


class HfremeshConan(ConanFile):
    name = "hfremesh"
    version = "0.1.0"
    license = "BSD-3-Clause"
    description = "Repairs and improves tetrahedral meshes in place, in parallel"
    settings = "os", "compiler", "build_type", "arch"
    options = {"shared": [True, False], "surface": [True, False]}
    default_options = {"shared": False, "surface": True}

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

    def generate(self):
        CMakeDeps(self).generate()
        toolchain = CMakeToolchain(self)
        toolchain.variables["BUILD_SHARED_LIBS"] = self.options.shared
        toolchain.variables["HFR_SURFACE"] = self.options.surface
        for off in ("HFR_TESTS", "HFR_TOOL", "HFR_C_API", "HFR_OPENCL"):
            toolchain.variables[off] = False
        toolchain.generate()

    def build(self):
        cmake = CMake(self)
        cmake.configure()
        cmake.build()

    def package(self):
        CMake(self).install()

    def package_info(self):
        self.cpp_info.libs = ["hfremesh"]
        self.cpp_info.cxxflags = ["-ffp-contract=off"]
        self.cpp_info.set_property("cmake_file_name", "hfremesh")
        self.cpp_info.set_property("cmake_target_name", "hfremesh::hfremesh")
