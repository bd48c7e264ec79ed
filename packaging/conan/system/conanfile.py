# SPDX-License-Identifier: BSD-3-Clause
# Stands in for one of the packages that hfremesh requires where none can be fetched: what the system has installed,
# under the names that the package of that name gives its CMake targets.
#   conan create packaging/conan/system --name=fmt --version=9.1.0
from conan import ConanFile

# File and target of CMake, the library, where the headers lie. OpenMesh's library is given as an option of the linker:
# CMake takes a library that is named like its target for the target itself, and links nothing.
SYSTEM = {
    "fmt": ("fmt", "fmt::fmt", ["fmt"], []),
    "tinyxml2": ("tinyxml2", "tinyxml2::tinyxml2", ["tinyxml2"], []),
    "zlib": ("ZLIB", "ZLIB::ZLIB", ["z"], []),
    "eigen": ("Eigen3", "Eigen3::Eigen", [], ["/usr/include/eigen3"]),
    "openmesh": ("OpenMesh", "OpenMeshCore", ["-lOpenMeshCore"], []),
}


class SystemPackage(ConanFile):
    settings = "os", "compiler", "build_type", "arch"
    package_type = "shared-library"

    def package_info(self):
        file, target, libraries, includes = SYSTEM[self.name]
        self.cpp_info.set_property("cmake_file_name", file)
        self.cpp_info.set_property("cmake_target_name", target)
        self.cpp_info.system_libs = libraries
        self.cpp_info.includedirs = includes
        self.cpp_info.libdirs = []
        self.cpp_info.bindirs = []
