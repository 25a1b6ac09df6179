#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Checks that every include follows the module table, that every source file carries its licence, that lines of code and
comments have at most 120 columns, and that the notice of third parties names every library that sources include.

usage: check_sources.py [ROOT]
Prints one line per violation, FILE:LINE: REASON. Exit code: 0 none, 1 some, 2 usage.
"""
import os
import re
import sys

# The module table, bottom to top: what each module may include beside itself. Permissions are transitive, except that
# "module/prefix" permits just the headers of that module whose names start with the prefix.
CORE = ["std", "eigen"]
STAGES_BELOW = ["broadphase", "islands", "pair"]
MODULES = {
    "base": [],
    "parallel": ["base"],
    "geometry": ["base"],
    "mesh": ["geometry", "parallel"],
    "scene": ["mesh"],
    "state": ["scene"],
    "query": ["state"],
    "broadphase": ["state"],
    "ccd": ["state"],
    "proximity": ["state", "ccd/feature_candidates", "ccd/leaf_features", "ccd/plane_features", "ccd/query_aid"],
    "islands": ["state"],
    "response": ["state"],
    "pair": ["ccd", "proximity", "response", "islands"],
    "collision": STAGES_BELOW,
    "static_contact": STAGES_BELOW,
    "dynamic_contact": STAGES_BELOW,
    "failsafe": STAGES_BELOW,
    # An independent proof: what it may share with the solver, header by header, beside vectors, rotations and asserts.
    "audit": ["base", "parallel/parallel_for.hpp", "geometry/exact", "mesh/placement.hpp", "mesh/triangle_mesh.hpp"],
    "step": ["collision", "static_contact", "dynamic_contact", "failsafe"],
    "io": ["state"],
    "api": ["step", "query", "io"],
    # Above the core (flotilla::core): what reads and writes runs.
    "run_folder": ["io", "step/report"],
    "picture": ["run_folder"],
    "trace": ["run_folder"],
    "report": ["run_folder"],
    "run": ["api", "audit", "report", "picture", "trace"],
    "sweep": ["run"],
    "cli": [],
    # Ranks: what it shares with the command, header by header.
    "mpi": ["sweep", "cli/member_run", "cli/run_action", "cli/commands", "cli/scene_options", "cli/stop_request",
            "cli/progress", "cli/value_checks"],
    "python": [],
}
# These see the library as an embedder does: any public header, no internal one.
EMBEDDERS = {"cli", "python"}

# The module a public header belongs to; one that is not listed belongs to api.
PUBLIC_HEADERS = {
    "types": "base",
    "error": "base",
    "build_info": "base",
    "environment": "base",
    "names": "base",
    "settings": "scene",
    "scene": "scene",
    "scene_file": "io",
    "edit": "scene",
    "edit_file": "io",
    "scene_library": "scene",
    "report": "step/report",
    "picture": "picture",
    "export": "run_folder",
    "compare": "run",
    "html_report": "run",
    "run": "run",
    "run_folder": "run",
    "step_picture": "run",
    "trace": "run",
    "verify": "run",
    "sweep": "sweep",
}

# Libraries beside std and Eigen, which every module but the embedders' headers may use.
LIBRARIES = {
    "parallel": ["openmp", "tbb", "threads", "locks", "posix"],
    "io": ["nlohmann", "xxhash", "posix"],
    "run_folder": ["locks", "nlohmann", "hdf5", "zlib", "posix"],
    "picture": ["png"],
    "report": ["nlohmann", "zlib"],
    "sweep": ["locks", "nlohmann"],
    "cli": ["cli11", "posix"],
    "mpi": ["cli11", "mpi", "nlohmann", "posix"],
    "python": ["pybind11"],
}
LIBRARY_OF = [
    (r"Eigen/", "eigen"),
    (r"(oneapi/)?tbb/", "tbb"),
    (r"omp\.h$", "openmp"),
    (r"nlohmann/", "nlohmann"),
    (r"(hdf5(_hl)?\.h|H5\w*\.h|hdf5/)", "hdf5"),
    (r"CLI/", "cli11"),
    (r"mpi\.h$", "mpi"),
    (r"xxh\w*\.h$", "xxhash"),
    (r"png(conf)?\.h$", "png"),
    (r"zlib\.h$", "zlib"),
    (r"pybind11/", "pybind11"),
    (r"(mutex|shared_mutex)$", "locks"),
    (r"(thread|condition_variable|future|execution|barrier|latch|semaphore|stop_token)$", "threads"),
    (r"\w*intrin\.h$", "std"),  # the compiler's own, for kernels compiled per instruction set
    (r"(sys/|linux/|malloc\.h$|unistd\.h$|fcntl\.h$|sched\.h$|pthread\.h$|signal\.h$|poll\.h$|dirent\.h$|dlfcn\.h$)", "posix"),
    (r"[a-z_]+$", "std"),  # <vector>, <cmath>: no other library here has headers without an extension or a folder
]

INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^">]+)[">]')
OPENMP_PRAGMA = re.compile(r"^\s*#\s*pragma\s+omp\b|\b_Pragma\s*\(\s*\"omp\b")
NOTICE = "scripts/cmake/NOTICE.txt"
SPDX = "SPDX-License-Identifier: MIT"
CODE_SUFFIXES = (".hpp", ".cpp", ".h", ".inl")
TEXT_SUFFIXES = CODE_SUFFIXES + (".py", ".sh", ".cmake", ".in", "CMakeLists.txt")


def permissions(module):
    """All modules and module/prefix entries that a module may include."""
    allowed = {module}
    for entry in MODULES[module]:
        allowed |= {entry} if "/" in entry else permissions(entry)
    return allowed


def permits(allowed, header):
    """header is "module/rest"."""
    return any(header == entry or header.startswith(entry + "/") or ("/" in entry and header.startswith(entry))
               for entry in allowed)


def library_of(header):
    for pattern, library in LIBRARY_OF:
        if re.match(pattern, header):
            return library
    return "unknown"


def check_public_include(owner, allowed, header):
    """An include <flotilla/...> from a module; owner is the module's name."""
    if owner in EMBEDDERS:
        return None
    name = re.sub(r"\.hpp$", "", header[len("flotilla/"):])
    home = PUBLIC_HEADERS.get(name, "api")
    if not permits(allowed, home if "/" in home else home + "/"):
        return f"{owner} may not include <{header}>, which belongs to {home.split('/')[0]}"
    return None


def check_include(owner, allowed, bracket, header):
    """Why a file of module `owner` may not have this include, or None."""
    if bracket == "<" and header.startswith("flotilla/"):
        return check_public_include(owner, allowed, header)
    if bracket == "<":
        library = library_of(header)
        if library in CORE or library in LIBRARIES.get(owner, []):
            return None
        return f"{owner} may not include <{header}> ({library})"
    module = header.split("/")[0]
    if module == owner:
        return None
    if module not in MODULES:
        return f'"{header}" must be named from src, as "module/header.hpp"'
    if owner in EMBEDDERS:
        return f'{owner} may include public headers only, not "{header}"'
    if not permits(allowed, header):
        return f'{owner} may not include "{header}"'
    return None


def check_public_header(name, bracket, header):
    """Why the public header flotilla/`name`.hpp may not have this include, or None: std and public headers only."""
    if bracket == "<" and header.startswith("flotilla/"):
        home = PUBLIC_HEADERS.get(name, "api").split("/")[0]
        return check_public_include(home, permissions(home), header)
    if bracket == "<" and library_of(header) == "std":
        return None
    return f"a public header may include std and public headers only, not {header}"


def read_lines(path):
    with open(path, encoding="utf-8") as file:
        return file.read().splitlines()


def check_code(root, path):
    """Violations of the module table in one file of src or include, as (line number, reason)."""
    parts = os.path.relpath(path, root).split(os.sep)
    public = parts[0] == "include"
    owner = None if public else parts[1]
    if not public and owner not in MODULES:
        yield 1, f"src/{owner} is not in the module table"
        return
    allowed = set() if public else permissions(owner)
    for number, line in enumerate(read_lines(path), 1):
        match = INCLUDE.match(line)
        if match and public:
            name = re.sub(r"\.hpp$", "", "/".join(parts[2:]))
            reason = check_public_header(name, *match.groups())
        elif match:
            reason = check_include(owner, allowed, *match.groups())
        elif len(line.rstrip("\n")) > LONGEST_LINE:
            reason = f"a line of {len(line.rstrip())} columns, {LONGEST_LINE} are the limit"
        else:
            outside = owner != "parallel" and OPENMP_PRAGMA.search(line)
            reason = "OpenMP outside of src/parallel" if outside else None
        if reason:
            yield number, reason


LONGEST_LINE = 120  # clang-format keeps code to it, and leaves comments as they are
NAME_IN_NOTICE = {"nlohmann": "nlohmann/json", "tbb": "oneTBB", "png": "libpng"}  # where it is not the library's own
OF_THE_SYSTEM = {"std", "posix", "locks", "threads", "unknown"}


def check_notice(root):
    """Libraries that files of src include and the notice does not name, as messages."""
    with open(os.path.join(root, NOTICE), encoding="utf-8") as file:
        notice = file.read().lower()
    used = set()
    for path in source_files(root):
        if os.path.relpath(path, root).startswith("src" + os.sep) and path.endswith(CODE_SUFFIXES):
            matches = filter(None, map(INCLUDE.match, read_lines(path)))
            used |= {library_of(m[2]) for m in matches if m[1] == "<" and not m[2].startswith("flotilla/")}
    for library in sorted(used - OF_THE_SYSTEM):
        if NAME_IN_NOTICE.get(library, library).lower() not in notice:
            yield f"{NOTICE}: does not name {library}, which sources include"


def check_licence(path):
    if not any(SPDX in line for line in read_lines(path)[:3]):
        yield 1, f'no "{SPDX}" in the first three lines'


def is_script(path):
    with open(path, "rb") as file:
        return file.read(2) == b"#!"


def source_files(root):
    for top in [".ci", "bench", "include", "scripts", "src", "tests"]:
        for folder, subfolders, names in os.walk(os.path.join(root, top)):
            subfolders[:] = sorted(name for name in subfolders if name != "__pycache__")
            yield from (os.path.join(folder, name) for name in sorted(names))
    yield os.path.join(root, "CMakeLists.txt")


def check_tree(root):
    violations = []
    for path in source_files(root):
        found = []
        if path.endswith(TEXT_SUFFIXES) or is_script(path):
            found += check_licence(path)
        in_library = os.path.relpath(path, root).split(os.sep)[0] in ("src", "include")
        if in_library and path.endswith(CODE_SUFFIXES):
            found += check_code(root, path)
        violations += [f"{os.path.relpath(path, root)}:{line}: {reason}" for line, reason in found]
    return violations + list(check_notice(root))


def main(arguments):
    if len(arguments) > 1:
        print(__doc__, file=sys.stderr)
        return 2
    root = arguments[0] if arguments else os.path.join(os.path.dirname(os.path.abspath(__file__)), "..")
    violations = check_tree(root)
    print("\n".join(violations) if violations else "every include follows the module table; every file has its licence")
    return 1 if violations else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
