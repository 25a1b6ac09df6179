# SPDX-License-Identifier: MIT
"""Recipe for Spack. There is no archive to fetch; of a checkout: `spack dev-build -d CHECKOUT flotilla@0.1.0`."""
from spack.package import *


class Flotilla(CMakePackage):
    """Rigid bodies given as triangle meshes, surfaces without thickness among them: no two ever intersect, and this is
    proved."""

    license("MIT")
    version("0.1.0")

    variant("shared", default=True, description="Build a shared library")
    variant("python", default=False, description="Build the Python module")

    depends_on("cxx", type="build")
    depends_on("cmake@3.25:", type="build")
    depends_on("ninja", type="build")
    depends_on("eigen@3.4:", type="build")
    depends_on("cli11@2.1:", type="build")
    depends_on("nlohmann-json@3.11:", type="build")
    depends_on("xxhash", type="build")
    depends_on("hdf5@1.10: +cxx")
    depends_on("libpng@1.6:")
    depends_on("zlib-api")
    depends_on("tbb")

    extends("python@3.9:", when="+python")
    depends_on("py-pybind11@2.10:", when="+python", type="build")
    depends_on("py-numpy", when="+python", type=("build", "run"))

    generator("ninja")

    def cmake_args(self):
        args = [
            self.define_from_variant("BUILD_SHARED_LIBS", "shared"),
            self.define_from_variant("FLOTILLA_PYTHON", "python"),
            self.define("FLOTILLA_BUILD_TESTS", False),
            self.define("FLOTILLA_BUILD_BENCH", False),
        ]
        if self.spec.satisfies("+python"):
            args.append(self.define("FLOTILLA_PYTHON_DESTINATION", python_platlib))
            args.append(self.define("Python_EXECUTABLE", self.spec["python"].command.path))
        return args

    @run_after("install", when="+python")
    def install_module(self):
        cmake = which("cmake")
        cmake("--install", self.build_directory, "--component", "python")
