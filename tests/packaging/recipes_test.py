# SPDX-License-Identifier: MIT
"""Recipes and citation are of the project's version, name what the build asks for, and the containers use what the
repository has.

usage: recipes_test.py VERSION
"""
import ast
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).parents[2]
PACKAGING = ROOT / "scripts" / "packaging"
SPACK_NAMES = {"Eigen3": "eigen", "CLI11": "cli11", "HDF5": "hdf5", "PNG": "libpng", "ZLIB": "zlib-api", "TBB": "tbb"}
OF_THE_COMPILER = {"Threads", "OpenMP", "Git", "Doxygen", "Python", "Python3", "pybind11", "${FLOTILLA_LINK_ARGUMENTS}"}


def packages_of_the_build():
    """Names in find_package and flotilla_link_package outside of tests and benchmarks."""
    files = [ROOT / "CMakeLists.txt", *(ROOT / "src").rglob("CMakeLists.txt")]
    for file in files:
        for name in re.findall(r"^\s*(?:find_package|flotilla_link_package)\((\S+?)[\s)]", file.read_text(), re.MULTILINE):
            yield name


def main(version):
    recipe = (PACKAGING / "package.py").read_text()
    ast.parse(recipe)
    citation = (PACKAGING / "CITATION.cff").read_text()
    assert f"\nversion: {version}\n" in citation, "CITATION.cff is of another version"
    assert f'version("{version}")' in recipe and f"flotilla@{version}" in recipe, "the Spack recipe is of another version"
    wanted = set(packages_of_the_build()) - OF_THE_COMPILER
    assert {"Eigen3", "HDF5", "TBB"} <= wanted, wanted
    for name in sorted(wanted):
        assert f'depends_on("{SPACK_NAMES.get(name, name.replace("_", "-"))}' in recipe, f"the Spack recipe does not name {name}"
    for name in ("Dockerfile", "flotilla.def"):
        text = (PACKAGING / name).read_text()
        for path in re.findall(r"\bscripts/[\w./]+", text):
            assert (ROOT / path).exists(), f"{name}: {path} does not exist"
        assert "cmake --preset run" in text and "cpack --config build/run/CPackConfig.cmake -G DEB" in text
    print("recipes, citation and containers agree with the project")


if __name__ == "__main__":
    main(sys.argv[1])
