#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What bench/accuracy/run reads of rows, and the page it writes: orders, fronts, costs, what is out of order; from rows made up here."""
import importlib.machinery
import importlib.util
import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = os.path.abspath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))
RUN = os.path.join(ROOT, "bench", "accuracy", "run")
sys.dont_write_bytecode = True
loader = importlib.machinery.SourceFileLoader("accuracy_run", RUN)
run = importlib.util.module_from_spec(importlib.util.spec_from_loader("accuracy_run", loader))
loader.exec_module(run)
rules, page = run.rules, run.accuracy_page


def problem(name, bound=0.01):
    return {"name": name, "about": f"the scene of {name}", "error": "way, relative", "bound": bound, "seconds": 2, "others_gap": 0, "solids": True, "sides": 0}


def ours(name, preset, rate, error, ms):
    row = {"problem": name, "preset": preset, "rate": rate, "complete": error is not None}
    return row if error is None else row | {"error": error, "ms": ms}


def theirs(name, engine, solver, iterations, rate, error, ms):
    row = {"problem": name, "engine": engine, "solver": solver, "iterations": iterations, "rate": rate, "complete": error is not None}
    return row if error is None else row | {"error": error, "ms": ms}


ROWS = [ours("slide", "balanced", 24, 0.02, 1), ours("slide", "balanced", 120, 0.004, 5), ours("slide", "balanced", 480, 0.008, 20),
        ours("slide", "accurate", 24, 0.05, 4), ours("slide", "accurate", 120, None, None),
        ours("hold", "balanced", 24, 0, 1)]
OTHERS = [theirs("slide", "Bullet", "impulses", 10, 240, 0.5, 0.4), theirs("slide", "Bullet", "impulses", 50, 240, 0.3, 0.9),
          theirs("slide", "Bullet", "impulses", 200, 960, 0.001, 9), theirs("slide", "ODE", "sweeps", 20, 240, 0.002, 0.8),
          theirs("slide", "ODE", "pivots", 0, 3840, None, None)]
SWEEP = {"duration_s": 5, "members": {"preset=preview@x 1": {"exit_code": 0, "cpu_s": 1}, "preset=preview@x 2": {"exit_code": 0, "cpu_s": 3},
                                      "preset=paper@x 1": {"exit_code": 1, "cpu_s": 30}, "preset=paper@x 2": {"exit_code": 0, "cpu_s": 20}},
         "results": {"metrics": [{"name": "height", "unit": "m"}],
                     "points": [{"label": "preset=" + name, "settings": {"preset": name},
                                 "metrics": {"height": {"error": error, "error_uncertainty": 0.001, "value": {"mean": 2.5}}}}
                                for name, error in (("preview", 0.0123456), ("paper", None))]}}


def results():
    return {"command": "bench/accuracy/run", "machine": "a machine", "commit": "0123", "date": "2000-01-01", "limit": 2.5,
            "problems": [problem("slide"), problem("hold", 1e-6)], "ours": ROWS, "engines": OTHERS,
            "fronts": [run.front_of(SWEEP, "pile", "a pile", ("height",), "reference")]}


class Rules(unittest.TestCase):
    def test_order_is_that_of_the_step(self):
        self.assertAlmostEqual(rules.order(ours("a", "balanced", 24, 0.25, 1), ours("a", "balanced", 120, 0.01, 5), 0.01), 2)
        self.assertIsNone(rules.order(ours("a", "balanced", 24, 1e-6, 1), ours("a", "balanced", 120, 1e-7, 5), 0.01))
        self.assertIsNone(rules.order(ours("a", "balanced", 24, 0.25, 1), ours("a", "balanced", 120, None, None), 0.01))
        self.assertIsNone(rules.order(None, ours("a", "balanced", 120, 0.01, 5), 0.01))

    def test_front_has_what_no_other_beats(self):
        rows = [ours("a", "p", 1, error, ms) for error, ms in ((3, 1), (4, 2), (1, 3), (rules.WRONG, 0.1), (None, None))]
        self.assertEqual([(r["error"], r["ms"]) for r in rules.front(rows)], [(3, 1), (1, 3)])
        self.assertEqual(rules.at_cost(rows, 2.9)["error"], 3)
        self.assertEqual(rules.at_cost(rows, 3)["error"], 1)
        self.assertIsNone(rules.at_cost(rows, 0.5))

    def test_out_of_order_are_dear_and_small_steps_that_are_less_right(self):
        found = [(p["name"], row["preset"], row["rate"], other["preset"], other["rate"], why)
                 for p, row, other, why in rules.out_of_order(results()["problems"], ROWS)]
        self.assertEqual(found, [("slide", "accurate", 24, "balanced", 24, "preset"), ("slide", "balanced", 480, "balanced", 120, "step")])

    def test_errors_far_below_the_bound_are_not_out_of_order(self):
        rows = [ours("slide", "balanced", 24, 1e-5, 1), ours("slide", "balanced", 120, 9e-4, 5)]
        self.assertEqual(rules.out_of_order([problem("slide")], rows), [])

    def test_neither_are_those_of_flat_sides_and_of_another_law(self):
        self.assertEqual(rules.out_of_order([problem("slide") | {"sides": 0.06}], ROWS), [])
        rows = [ours("slide", "balanced", 24, 0.02, 1), ours("slide", "paper", 24, 1, 5)]
        self.assertEqual(rules.out_of_order([problem("slide")], rows), [])


class Page(unittest.TestCase):
    def test_page_says_who_is_better_at_whose_cost(self):
        text = page.text_of(results())
        self.assertIn("| balanced | 0.02 (1) | 0.004 (5) | 0.008 (20) | 1.0 | -0.5 |", text)
        self.assertIn("| accurate | 0.05 (4) | given up |", text)
        self.assertIn("| slide | 1 | 0.02 | 0.3 (impulses 50 1/240) | 0.002 (sweeps 20 1/240) |", text)
        self.assertIn("| slide | 0.4 | 0.5 | none as cheap | 0.8 | 0.002 | none as cheap |", text)
        self.assertIn("**Bullet at the cost of balanced, 1/24 s**: more accurate in 0; less accurate in 1 (slide)", text)
        self.assertIn("**ODE at the cost of balanced, 1/24 s**: more accurate in 1 (slide); less accurate in 0", text)
        self.assertIn("flotilla: slide accurate 1/120.", text)
        self.assertIn("Others: slide ODE pivots 1/3840.", text)

    def test_front_means_over_seeds_and_names_what_was_given_up(self):
        front = results()["fronts"][0]
        self.assertEqual([(p["preset"], p["cpu"], p["error"], p["note"]) for p in front["points"]],
                         [("preview", 2, 0.01235, None), ("paper", 25, None, "given up")])
        self.assertIn("| paper | 25 | given up |", page.text_of(results()))

    def test_page_of_nothing_measured_says_so(self):
        text = page.text_of(results() | {"ours": [], "engines": [], "fronts": []})
        self.assertIn("Not run: the engines' packages", text)
        self.assertIn("None.", text)


class Command(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder)

    def call(self, *words):
        return subprocess.run([sys.executable, RUN, "--output", self.folder, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def test_json_keeps_everything(self):
        path = os.path.join(self.folder, "accuracy.json")
        run.write_json(path, results())
        with open(path, encoding="utf-8") as file:
            self.assertEqual(json.load(file), results())

    def test_check_finds_a_page_that_is_not_of_the_results(self):
        run.write_json(os.path.join(self.folder, "accuracy.json"), results())
        path = os.path.join(self.folder, "accuracy.md")
        with open(path, "w", encoding="utf-8") as file:
            file.write(page.text_of(results()))
        self.assertEqual(self.call("--check").returncode, 0)
        with open(path, "a", encoding="utf-8") as file:
            file.write("more\n")
        done = self.call("--check")
        self.assertEqual((done.returncode, "is not what" in done.stderr), (1, True))

    def test_usage(self):
        self.assertEqual(run.parse(["--quick"]).problem, list(run.QUICK))
        self.assertEqual(run.parse(["--only", "fronts"]).only, ["fronts"])
        self.assertEqual(self.call("--only", "nothing").returncode, 2)
        self.assertEqual(self.call("--quick", "--page").returncode, 2)
        done = self.call("--page")
        self.assertEqual((done.returncode, "nothing to go on with" in done.stderr), (5, True))

    def test_problem_replaces_its_rows_alone(self):
        new = [ours("slide", "balanced", 24, 1, 1)]
        rows = run.replace(ROWS, new, ["slide"])
        self.assertEqual(run.in_order(rows, results()["problems"]), new + [ROWS[-1]])


if __name__ == "__main__":
    unittest.main()
