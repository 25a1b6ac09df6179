#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Runs or compiles every code sample of every page, or knows which test does.

usage: samples_test.py FLOTILLA CMAKE COMPILER
A page is a Markdown file outside of bench/results (those are written by programs). A sample is a fenced block of one of the
languages below; a block that SAMPLES does not know fails the test, and so does one that SAMPLES knows and no page has.
"""
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
LANGUAGES = {"sh", "cpp", "cmake", "json", "python", "console"}
NO_SAMPLES = {"text"}  # diagrams


class Failure(Exception):
    pass


def blocks(page):
    """(line number, language, text) of the fenced blocks of a page."""
    found, start = [], None
    for number, line in enumerate((ROOT / page).read_text(encoding="utf-8").splitlines(), 1):
        if line.startswith("```") and start is None:
            start, language, text = number, line[3:].strip(), []
        elif line.startswith("```"):
            found.append((start, language, "\n".join(text) + "\n"))
            start = None
        elif start is not None:
            text.append(line)
    if start is not None:
        raise Failure(f"{page}:{start}: the block does not end")
    return found


def pages():
    skipped = {"build", "out", "results", "__pycache__"}
    for folder, subfolders, names in os.walk(ROOT):
        subfolders[:] = sorted(n for n in subfolders if n not in skipped and not n.startswith("."))
        for name in sorted(names):
            if name.endswith(".md"):
                yield os.path.relpath(os.path.join(folder, name), ROOT)


def run(command, folder, **options):
    ended = subprocess.run(command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, **options)
    if ended.returncode != 0:
        raise Failure(f"{command}\nexit code {ended.returncode}\n{ended.stdout[-4000:]}")
    return ended.stdout


def check_against_help(line):
    """A command that builds or measures for long is not run: it is there, and its --help has the options of the sample."""
    words = shlex.split(line, comments=True)
    if not os.access(ROOT / words[0], os.X_OK):
        raise Failure(f"{words[0]} is no program")
    subcommands = [w for w in words[1:2] if re.fullmatch(r"[a-z]+", w) and "{" in run([words[0], "--help"], ROOT)]
    says = run([words[0], *subcommands, "--help"], ROOT)
    for option in (w for w in words[1:] if w.startswith("--")):
        if not re.search(re.escape(option) + r"(?![\w-])", says):
            raise Failure(f"--help of {words[0]} does not have {option}")


class Shell:
    """Runs a block line by line as a shell would, in an empty folder: scaled down by `scaled`, (pattern, replacement)
    pairs each of which must match, and with `files`, the block's name of a file and where that is in the repository.
    `after` are commands that fail where the block did not do what its page says."""

    def __init__(self, scaled=(), files=(), before="", after=""):
        self.scaled, self.files, self.before, self.after = scaled, files, before, after

    def __call__(self, tools, text, folder):
        for name, source in self.files:
            shutil.copy(ROOT / source, folder / name)
        for line in text.splitlines():
            if re.match(r"(scripts|bench)/", line):
                check_against_help(line)
        text = re.sub(r"(?m)^(scripts|bench)/.*\n", "", text)
        for pattern, replacement in self.scaled:
            text, times = re.subn(pattern, replacement, text)
            if times == 0:
                raise Failure(f"nothing in it is {pattern!r}")
        environment = dict(os.environ, PATH=f"{tools.flotilla.parent}{os.pathsep}{os.environ['PATH']}")
        run(["bash", "-euo", "pipefail", "-c", "\n".join((self.before, text, self.after))], folder, env=environment)


def compile_statements(tools, text, folder):
    """C++ statements with every public header before them."""
    headers = "".join(f"#include <flotilla/{h.name}>\n" for h in sorted((ROOT / "include" / "flotilla").glob("*.hpp")))
    (folder / "sample.cpp").write_text(f"#include <cstdio>\n{headers}int main() {{\n{text}}}\n")
    run([tools.compiler, "-std=c++20", "-fsyntax-only", "-I", str(ROOT / "include"), "sample.cpp"], folder)


def check_preset(tools, text, folder):
    preset = re.fullmatch(r"cmake --workflow --preset (\w+)\s*(#.*)?\n", text)
    if not preset or f'"{preset[1]}"' not in run([tools.cmake, "--workflow", "--list-presets"], ROOT):
        raise Failure("there is no such workflow")


class By:
    """Another test takes the sample from its page: `test` names that page."""

    def __init__(self, test, page):
        self.test, self.page = test, page

    def __call__(self, tools, text, folder):
        if self.page not in (ROOT / self.test).read_text(encoding="utf-8"):
            raise Failure(f"{self.test} does not take it from {self.page}")


README_TEST = "tests/embedding/readme_test.sh"
SMALL = (r"--bodies 102", "--bodies 5")
# Page, what the block starts with, how it is tried.
SAMPLES = [
    ("README.md", "scripts/run ", Shell()),
    ("README.md", "export PATH", By(README_TEST, "README.md")),
    ("README.md", "mkdir -p out\ncat > out/lid.json", By(README_TEST, "out/lid.json")),
    ("README.md", "#include <cstdio>", By(README_TEST, "int main")),
    ("README.md", "find_package(flotilla", By(README_TEST, "README.md")),
    ("bench/README.md", "bench/baseline/compare_engines --start", Shell(
        scaled=[(r"DIR/scene.json --poses TRAJECTORY.csv", "scene.json --poses poses.csv")],
        before="flotilla scene stack --bodies 3 > scene.json; flotilla run scene.json --steps 3 --output run --quiet\n"
               "flotilla export run --format csv --output poses.csv")),
    ("scripts/packaging/api.md", "flotilla::World world", compile_statements),
    ("src/BUILDING.md", "cmake --workflow", check_preset),
    ("src/BUILDING.md", "cmake --install", By(README_TEST, "src/BUILDING.md")),
    ("src/BUILDING.md", "find_package(flotilla 0.1 CONFIG REQUIRED)", By(README_TEST, "src/BUILDING.md")),
    ("src/BUILDING.md", "find_package(flotilla 0.1 CONFIG REQUIRED COMPONENTS core)", By(README_TEST, "src/BUILDING.md")),
    ("src/api/README.md", "flotilla::World world", compile_statements),
    ("src/cli/README.md", "flotilla scene boats-in-bowl", Shell(
        scaled=[SMALL, (r"--steps 200", "--steps 6"), (r"--step 60", "--step 4"),
                (r"(flotilla picture.*\.png)", r"\1 --width 64 --height 48"),
                (r"(run boats.json) (--contacts|--threads 1 --trace)", r"\1 --steps 4 \2")],
        files=[("rigid-ipc.json", "tests/fuzz/corpus/scene/rigid_ipc.json"),
               ("queries.csv", "tests/fuzz/corpus/ccd/hits.csv")],
        after="[[ -s boats.csv && -s boats/report.html && -s boats.png && -s step60.png && -s contacts-bodies.csv ]]")),
    ("src/cli/README.md", "for i in 1 2 3", Shell(
        scaled=[(r"--steps 240", "--steps 9")], before="flotilla scene stack --bodies 3 > boats.json")),
    ("src/cli/README.md", "flotilla sweep", Shell(
        scaled=[(r"boats-in-bowl --bodies 102 --seeds 5", "stack --bodies 3 --seeds 2 --duration 0.2")],
        after="[[ $(ls sweep | grep -c .) -gt 3 ]]")),
    ("src/cli/README.md", "flotilla run boats.json --output long", Shell(
        scaled=[(r"--steps 240", "--steps 4"), (r"--steps 480", "--steps 8")],
        before="flotilla scene stack --bodies 3 > boats.json", after="[[ $(wc -l < long/steps.csv) == 9 ]]")),
    ("src/io/README.md", '{ "flotilla_scene"', By(README_TEST, "src/io/README.md")),
    ("src/io/README.md", '{ "flotilla_edits"', By(README_TEST, "src/io/README.md")),
    ("src/python/README.md", "pip install", By("tests/python/test_install.py", "--no-build-isolation")),
    ("src/python/README.md", "import flotilla", By("tests/python/test_examples.py", '"python" / "README.md"')),
    ("src/mpi/README.md", "mpirun -np 4", By("tests/mpi/pages_test.cpp", "mpi/README.md")),
    ("src/mpi/README.md", "mpirun -np 8", By("tests/mpi/pages_test.cpp", "mpi/README.md")),
    ("src/run/README.md", "flotilla scene boats-in-bowl", Shell(
        scaled=[(r"--bodies 30", "--bodies 5"), (r"--output step60.png", "--output step60.png --width 64 --height 48")],
        after="[[ -s step60.png ]]")),
    ("src/sweep/README.md", "flotilla sweep boats-in-bowl", Shell(
        scaled=[(r"boats-in-bowl --bodies 102", "stack --bodies 3 --duration 0.2"), (r"--duration 4", "--duration 0.2"),
                (r"--seeds 5", "--seeds 2"), (r"(static_iterations=50,200,1000)", r"\1 --duration 0.2")],
        before="for s in stack a b c; do flotilla scene stack --bodies 3 > $s.json; done")),
]


class Tools:
    def __init__(self, flotilla, cmake, compiler):
        self.flotilla, self.cmake, self.compiler = pathlib.Path(flotilla).resolve(), cmake, compiler


def sample_of(page, text):
    """The entry for a block: the one with the longest beginning."""
    fits = [s for s in SAMPLES if s[0] == page and text.startswith(s[1])]
    return max(fits, key=lambda s: len(s[1]), default=None)


def main(tools):
    failures, seen = [], []
    for page in pages():
        for line, language, text in blocks(page):
            if language in NO_SAMPLES:
                continue
            where = f"{page}:{line}"
            sample = sample_of(page, text)
            try:
                if language not in LANGUAGES:
                    raise Failure(f"a block of language {language!r}")
                if sample is None:
                    raise Failure("no test knows this sample; add it to SAMPLES of tests/pages/samples_test.py")
                seen.append(sample)
                with tempfile.TemporaryDirectory(prefix="flotilla-page-") as folder:
                    sample[2](tools, text, pathlib.Path(folder))
                print(f"{where}: {sample[2].test if isinstance(sample[2], By) else 'tried'}", flush=True)
            except Failure as failure:
                failures.append(f"{where}: {failure}")
    failures += [f"{s[0]} has no sample that starts with {s[1]!r}" for s in SAMPLES if seen.count(s) != 1]
    print("\n".join(failures) if failures else f"{len(seen)} samples")
    return 1 if failures else 0


if __name__ == "__main__":
    if len(sys.argv) != 4:
        print(__doc__, file=sys.stderr)
        sys.exit(2)
    sys.exit(main(Tools(*sys.argv[1:])))
