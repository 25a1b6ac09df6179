#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Checks that what the pages point to is there: relative links with their anchors, and the paths and names in backticks.

usage: check_links.py [ROOT]
A path in backticks is checked where it begins with a folder of the repository (`src/ccd`), of src (`parallel/team.hpp`) or
beside the page (`results/speed.md`), or is the bare name of a source file (`team.hpp`). Endings may be left out, * stands for
any name, and what is built or written (build/, out/) is not looked for. In pages of src, names in backticks that only code has
(`find_hits`, `PairRecord`, `Clusters::evolve`, `kStaticLimit`) must be in some source, so that a page does not outlive what it
tells. Pages (src/pair/README.md#anchor) and sources with their endings (pair/examine.hpp) in comments of sources must be there too.
Prints one line per dead reference, FILE:LINE: REASON. Exit code: 0 none, 1 some, 2 usage.
"""
import fnmatch
import os
import re
import sys

SKIPPED_FOLDERS = {"build", "out", "__pycache__"}
SOURCES = (".hpp", ".cpp", ".py", ".sh", ".txt", ".cmake")
TOP = ("src", "include", "tests", "bench", "scripts")
COMMENT_PLACES = ("", "src", "include", "tests")

FENCE = re.compile(r"^\s*(```|~~~)")
HEADING = re.compile(r"^(#{1,6})\s+(.*?)\s*#*\s*$")
SPAN = re.compile(r"(`+)(.+?)\1")
LINK = re.compile(r"!?\[(?:[^\[\]]|\[[^\]]*\]\([^)]*\))*\]\(\s*<?([^)\s>]+)>?(?:\s+\"[^\"]*\")?\s*\)")
PLACE = re.compile(r"^(\.\./)*[\w*.][\w.*+-]*(/[\w.*+-]+)*/?(#[\w-]+)?$")
SOURCE_NAME = re.compile(r"^[\w*-]+\.(hpp|cpp|py|sh)$")
NAME = re.compile(r"^[A-Za-z_]\w*(::~?\w+)*(\(\))?$")
CODE_ONLY = re.compile(r"::|_|[a-z][A-Z]|^k[A-Z]")
NAMED_IN = (".hpp", ".cpp", ".py", ".sh", ".in", ".cmake", "CMakeLists.txt", ".json", ".pyi", ".js")
COMMENT = re.compile(r"(?:^|\s)//+<?\s.*")
SOURCE_IN_COMMENT = re.compile(r"(?<![\w./-])((?:[\w-]+/)+[\w-]+\.(?:hpp|cpp))\b")
PAGE_IN_COMMENT = re.compile(r"\b((?:src|bench|tests|scripts)/(?:[\w-]+/)*[\w-]+\.md(?:#[\w-]+)?)")


class Tree:
    """The files and folders of a repository."""

    def __init__(self, root):
        self.root = root
        self.paths, self.names = set(), set()
        for folder, subfolders, files in os.walk(root):
            subfolders[:] = [n for n in subfolders if n not in SKIPPED_FOLDERS and (n == ".ci" or not n.startswith("."))]
            for name in subfolders + files:
                self.paths.add(os.path.relpath(os.path.join(folder, name), root).replace(os.sep, "/"))
            self.names.update(files)
        self.stems = {name.split(".")[0] for name in self.names}
        self.modules = {p.split("/")[1] for p in self.paths if p.startswith("src/") and p.count("/") > 1}
        self.anchors_of = {}
        self.all_words = None

    def has(self, path):
        """Whether there is something of that name; its ending may be left out, and * is any name."""
        path = os.path.normpath(path).replace(os.sep, "/")
        if path in self.paths or path == ".":
            return True
        patterns = (path, path + ".*")
        if "*" in path:
            return any(fnmatch.fnmatch(p, pattern) for p in self.paths for pattern in patterns)
        return any(p.startswith(path + ".") for p in self.paths)

    def words(self):
        """All words of sources and scripts."""
        if self.all_words is None:
            self.all_words = set()
            for path in sorted(self.paths):
                scripts = path.startswith(("scripts/", "bench/")) and "." not in os.path.basename(path)
                if path.split("/")[0] not in TOP or not (path.endswith(NAMED_IN) or scripts):
                    continue
                if "/results/" not in path and os.path.isfile(os.path.join(self.root, path)):
                    with open(os.path.join(self.root, path), encoding="utf-8", errors="replace") as file:
                        self.all_words.update(re.findall(r"\w+", file.read()))
        return self.all_words

    def anchors(self, page):
        if page not in self.anchors_of:
            self.anchors_of[page] = anchors(read_lines(os.path.join(self.root, page)))
        return self.anchors_of[page]


def read_lines(path):
    with open(path, encoding="utf-8") as file:
        return file.read().splitlines()


def prose(lines):
    """(number, line) of the lines outside of fenced blocks."""
    inside = False
    for number, line in enumerate(lines, 1):
        if FENCE.match(line):
            inside = not inside
        elif not inside:
            yield number, line


def anchors(lines):
    """The anchors that code forges give the headings of a page."""
    found, used = set(), {}
    for _, line in prose(lines):
        heading = HEADING.match(line)
        if not heading:
            continue
        text = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", heading[2]).replace("`", "")
        slug = re.sub(r"[^\w\- ]", "", text.lower()).replace(" ", "-")
        found.add(f"{slug}-{used[slug]}" if slug in used else slug)
        used[slug] = used.get(slug, 0) + 1
    return found


def check_target(tree, page, target):
    """Why a link of the page is dead, or None."""
    path, _, anchor = target.partition("#")
    path = os.path.normpath(os.path.join(os.path.dirname(page), path)) if path else page
    if path.startswith(".."):
        return f"{target} leaves the repository"
    if path not in tree.paths and path != ".":
        return f"{target} is not there"
    if anchor and (not path.endswith(".md") or anchor not in tree.anchors(path)):
        return f"{path} has no heading #{anchor}"
    return None


def is_place(tree, page, text):
    """Whether the text in backticks is meant as a path of the repository."""
    if not PLACE.match(text):
        return False
    first, slash, _ = text.partition("/")
    if first == "..":
        return not os.path.normpath(os.path.join(os.path.dirname(page), text)).startswith("..")
    beside = os.path.join(os.path.dirname(page), first).replace(os.sep, "/")
    known = first in TOP or first in tree.modules or first == "flotilla" or beside in tree.paths
    return bool(SOURCE_NAME.match(text)) or slash and known


def check_place(tree, page, text):
    """Why a path in backticks is dead, or None."""
    path, _, anchor = text.rstrip("/").partition("#")
    if anchor:
        return check_target(tree, "", text)
    if SOURCE_NAME.match(path) and "*" not in path:
        return None if path in tree.names else f"no file is called `{text}`"
    here = os.path.dirname(page)
    if any(tree.has(os.path.join(place, path)) for place in (here, "", "src", "include", "tests")):
        return None
    return f"`{text}` is not there"


def check_name(tree, page, text):
    """Why a name in backticks is dead, or None."""
    if not page.startswith("src/") or not NAME.match(text) or not CODE_ONLY.search(text):
        return None
    missing = [word for word in re.findall(r"\w+", text) if word not in tree.words() and word not in tree.stems]
    return f"no source has the name `{missing[0]}`" if missing else None


def check_page(tree, page):
    for number, line in prose(read_lines(os.path.join(tree.root, page))):
        for match in SPAN.finditer(line):
            text = match[2].strip()
            if is_place(tree, page, text):
                reason = check_place(tree, page, text)
            else:
                reason = check_name(tree, page, text)
            if reason:
                yield number, reason
        for match in LINK.finditer(line):
            for target in [match[1]] + re.findall(r"\]\(([^)\s]+)\)", match[0])[:-1]:
                if not re.match(r"[a-z]+:", target) and (reason := check_target(tree, page, target)):
                    yield number, reason


def check_comments(tree, path):
    for number, line in enumerate(read_lines(os.path.join(tree.root, path)), 1):
        for match in PAGE_IN_COMMENT.finditer(line):
            if reason := check_target(tree, "", match[1]):
                yield number, reason
        comment = COMMENT.search(line) if path.endswith((".hpp", ".cpp")) else None
        for match in SOURCE_IN_COMMENT.finditer(comment[0]) if comment else ():
            first = match[1].split("/")[0]
            ours = first in TOP or first in tree.modules or first == "flotilla"
            if ours and not any(os.path.normpath(os.path.join(place, match[1])) in tree.paths for place in COMMENT_PLACES):
                yield number, f"{match[1]} is not there"


def check_tree(root):
    tree = Tree(root)
    found = []
    for path in sorted(tree.paths):
        violations = []
        if path.endswith(".md"):
            violations = check_page(tree, path)
        elif path.split("/")[0] in ("src", "include") and path.endswith(SOURCES):
            violations = check_comments(tree, path)
        found += [f"{path}:{number}: {reason}" for number, reason in violations]
    return found


def main(arguments):
    if arguments == ["--help"]:
        print(__doc__)
        return 0
    if len(arguments) > 1:
        print(__doc__, file=sys.stderr)
        return 2
    root = arguments[0] if arguments else os.path.join(os.path.dirname(os.path.abspath(__file__)), "..")
    violations = check_tree(root)
    print("\n".join(violations) if violations else "every link, anchor and path of the pages is there")
    return 1 if violations else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
