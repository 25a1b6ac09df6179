#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Plants dead references in pages and comments and expects scripts/check_links.py to name each of them."""
import contextlib
import io
import os
import shutil
import sys
import tempfile
import unittest

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..")
sys.path.insert(0, os.path.join(ROOT, "scripts"))
sys.dont_write_bytecode = True
import check_links  # noqa: E402  (the path comes first)


class CheckLinks(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder)
        self.plant("src/ccd/hull_gap.hpp", "// SPDX-License-Identifier: MIT\n")
        self.plant("src/ccd/README.md", "# Collision detection\n\n## What `hull_gap` is, and why\n\n## Files\n\n## Files\n")
        self.plant("include/flotilla/world.hpp", "")
        self.plant("picture.png", "")

    def plant(self, path, text):
        path = os.path.join(self.folder, path)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)

    def found(self, text, page="README.md"):
        """What is said of a page that ends with the text."""
        self.plant(page, "# A page\n\n" + text + "\n")
        return check_links.check_tree(self.folder)

    def expect_dead(self, text, reason, page="README.md"):
        self.assertEqual(self.found(text, page), [f"{page}:3: {reason}"])

    def expect_alive(self, text, page="README.md"):
        self.assertEqual(self.found(text, page), [])

    def test_links_need_a_file(self):
        self.expect_alive("[pages](src/ccd/README.md), ![a picture](picture.png), [web](https://example.org/none)")
        self.expect_dead("[pages](src/ccd/NONE.md)", "src/ccd/NONE.md is not there")
        self.expect_dead("![a picture](none.png)", "none.png is not there")
        self.expect_dead("[outside](../elsewhere.md)", "../elsewhere.md leaves the repository")

    def test_links_go_by_the_folder_of_their_page(self):
        self.expect_alive("[top](../../picture.png), [beside](hull_gap.hpp)", "src/ccd/OTHER.md")
        self.expect_dead("[top](picture.png)", "picture.png is not there", "src/ccd/OTHER.md")

    def test_a_picture_that_is_a_link_counts_twice(self):
        self.expect_alive("[![a picture](picture.png)](src/ccd/README.md)")
        self.expect_dead("[![a picture](none.png)](src/ccd/README.md)", "none.png is not there")

    def test_anchors_are_those_of_headings(self):
        self.expect_alive("[why](src/ccd/README.md#what-hull_gap-is-and-why), [second](src/ccd/README.md#files-1)")
        self.expect_alive("[here](#a-page)")
        self.expect_dead("[third](src/ccd/README.md#files-2)", "src/ccd/README.md has no heading #files-2")
        self.expect_dead("[here](#nowhere)", "README.md has no heading #nowhere")

    def test_paths_in_backticks_need_a_file_or_a_folder(self):
        self.expect_alive("`src/ccd`, `ccd/hull_gap.hpp`, `src/ccd/hull_gap`, `flotilla/world.hpp`, `src/*/README.md`")
        self.expect_dead("`src/none`", "`src/none` is not there")
        self.expect_dead("`ccd/none.hpp`", "`ccd/none.hpp` is not there")
        self.expect_dead("`src/*/NONE.md`", "`src/*/NONE.md` is not there")

    def test_bare_names_of_sources_are_those_of_some_file(self):
        self.expect_alive("`hull_gap.hpp`")
        self.expect_dead("`hull_gaps.hpp`", "no file is called `hull_gaps.hpp`")

    def test_other_code_is_left_alone(self):
        self.expect_alive("`a/b`, `build/release/none`, `out/none.png`, `--set key=value`, `src/none is one`")
        self.expect_alive("```sh\ncat src/none [x](none.md)\n```")

    def test_names_of_code_in_pages_of_src_are_in_some_source(self):
        self.plant("src/ccd/hull_gap.cpp", "struct HullGap {}; constexpr int kTrials = 5; void find_hull_gap() {}\n")
        self.expect_alive("`find_hull_gap`, `HullGap::kTrials`, `hull_gap`, `find_hull_gap()`, plain `words`", "src/ccd/OTHER.md")
        self.expect_dead("`find_hull_gaps`", "no source has the name `find_hull_gaps`", "src/ccd/OTHER.md")
        self.expect_dead("`HullGap::kTrial`", "no source has the name `kTrial`", "src/ccd/OTHER.md")
        self.plant("src/ccd/OTHER.md", "")
        self.expect_alive("`find_hull_gaps`")

    def test_comments_name_pages_that_are_there(self):
        self.plant("src/ccd/query.cpp", "// See src/ccd/README.md#files and src/pair/README.md.\n")
        self.assertEqual(check_links.check_tree(self.folder), ["src/ccd/query.cpp:1: src/pair/README.md is not there"])
        self.plant("src/ccd/query.cpp", "// See src/ccd/README.md#nowhere.\n")
        self.assertEqual(check_links.check_tree(self.folder),
                         ["src/ccd/query.cpp:1: src/ccd/README.md has no heading #nowhere"])

    def test_comments_name_sources_that_are_there(self):
        self.plant("src/ccd/query.cpp", "// See ccd/hull_gap.hpp, src/ccd/hull_gap.hpp, flotilla/world.hpp, elsewhere/none.hpp.\n"
                                        "int k; ///< (ccd/hull_gap.hpp)\n#include \"ccd/none.hpp\"\n")
        self.assertEqual(check_links.check_tree(self.folder), [])
        self.plant("src/ccd/query.cpp", "// See ccd/none.hpp.\nint k; ///< of flotilla/none.hpp\n")
        self.assertEqual(check_links.check_tree(self.folder),
                         ["src/ccd/query.cpp:1: ccd/none.hpp is not there", "src/ccd/query.cpp:2: flotilla/none.hpp is not there"])

    def test_prints_what_it_found(self):
        with contextlib.redirect_stdout(io.StringIO()) as output:
            self.assertEqual(check_links.main([self.folder]), 0)
            self.plant("README.md", "[x](none.md)\n")
            self.assertEqual(check_links.main([self.folder]), 1)
        self.assertEqual(output.getvalue(), "every link, anchor and path of the pages is there\n"
                                            "README.md:1: none.md is not there\n")


if __name__ == "__main__":
    unittest.main()
