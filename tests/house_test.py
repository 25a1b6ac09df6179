#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Counts a small tree by hand and expects scripts/house to count the same."""
import importlib.machinery
import importlib.util
import os
import subprocess
import sys
import tempfile
import unittest

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..")
sys.dont_write_bytecode = True
LOADER = importlib.machinery.SourceFileLoader("house", os.path.join(ROOT, "scripts", "house"))
house = importlib.util.module_from_spec(importlib.util.spec_from_loader("house", LOADER))
LOADER.exec_module(house)

HEADER = """#pragma once
#include "base/vec3.hpp"
namespace flotilla {
enum class Kind { a, b };
constexpr double kShare = 0.1; // of a length
constexpr std::size_t kMost{3};
struct Body {
    double mass = 0;
    std::vector<int> a, b; ///< "{" in text; is no block
    [[nodiscard]] bool still() const { return mass == 0; }
    static constexpr int kIds = 2;
};
class Table {
  public:
    explicit Table(int n);
    int open = 0;

  private:
    int closed_ = 0;
};
} // namespace flotilla
"""


class House(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root, house.ROOT = folder.name, folder.name

    def plant(self, path, text):
        path = os.path.join(self.root, "src", path)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)

    def test_functions_fields_and_constants_are_counted_by_module(self):
        long_body = "".join(f"    if (i == {k}) {{ f([&] {{ return {k}; }}); }}\n" for k in range(58))
        self.plant("base/vec3.hpp", "struct Vec3 {\n    double x, y, z;\n};\n")
        self.plant("pair/table.hpp", HEADER)
        self.plant("pair/table.cpp", '#include "pair/table.hpp"\n\nTable::Table(int n)\n    : open(n) {\n' + long_body + "    g();\n}\n")
        modules, long_ones, arrows, module_circles, file_circles = house.measure(None)
        files, lines, long_files, _, functions, long_functions, fields, constants = modules["pair"]
        self.assertEqual((files, functions, long_functions, long_files), (2, 2, 1, 0))
        self.assertEqual(long_ones, [("src/pair/table.cpp", 62, "Table::Table")])
        self.assertEqual(fields, 4)  # mass, a, b and open
        self.assertEqual(constants, 3)
        self.assertEqual(modules["base"][6], 3)
        self.assertEqual((dict(arrows), module_circles, file_circles), ({"pair": {"base"}}, [], []))

    def test_circles_of_modules_and_files_are_found(self):
        self.plant("base/a.hpp", '#include "mesh/b.hpp"\n')
        self.plant("mesh/b.hpp", '#include "base/c.hpp"\n')
        self.plant("base/c.hpp", '#include "base/d.hpp"\n')
        self.plant("base/d.hpp", '#include "base/c.hpp"\n')
        *_, modules, files = house.measure(None)
        self.assertEqual(modules, ["base", "mesh"])
        self.assertEqual(files, ["src/base/c.hpp", "src/base/d.hpp"])

    def test_an_unknown_commit_is_refused(self):
        command = [os.path.join(ROOT, "scripts", "house"), "--at", "no-such-commit"]
        result = subprocess.run(command, capture_output=True, text=True)
        self.assertEqual(result.returncode, 2)
        self.assertIn("no-such-commit", result.stderr)


if __name__ == "__main__":
    unittest.main()
