#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""scripts/profile: which stage a sample belongs to, what its table adds up to, and a small run by each of its ways.

usage: profile_test.py COMMAND
"""
import importlib.machinery
import importlib.util
import os
import re
import subprocess
import sys
import unittest

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
SCRIPT = os.path.join(ROOT, "scripts", "profile")
sys.dont_write_bytecode = True
loader = importlib.machinery.SourceFileLoader("profile_script", SCRIPT)
profile = importlib.util.module_from_spec(importlib.util.spec_from_loader("profile_script", loader))
loader.exec_module(profile)

COMMAND = ""

SAMPLES = """
            1a2b flotilla::(anonymous namespace)::closest<double>
            2b3c flotilla::handle_collisions
            3c4d flotilla::Stepper::advance

            1a2b [unknown]
            2b3c flotilla::(anonymous namespace)::Failsafe::run
            3c4d flotilla::run_failsafe

            1a2b flotilla::parse_json[abi:cxx11]

            1a2b flotilla::(anonymous namespace)::closest<float>
            2b3c flotilla::handle_collisions

"""

ROWS = """phase,kind,number,regions,tasks,wall_ms,serial_ms,work_ms,critical_path_ms,parallelism
step,phase,2,9,9,9,1,9,9,1
step/start pairs,loop,2,2,2,1,0,0.5,1,1
step/stage7_static_contact,phase,2,3,3,6,0.75,6,6,1
step/stage7_static_contact/static_response,phase,2,3,3,6,0.25,5,6,1
step/stage7_static_contact/static_response/small islands,loop,2,3,3,6,0,3,6,1
step/stage7_static_contact/static_response/rest,rest,2,0,0,1,0.25,0.25,0.25,1
step/stage7_static_contact/small islands,loop,2,3,3,6,0,1,6,1
step/rest,rest,2,0,0,1,0.125,0.125,0.125,1
total,phase,2,9,9,9,1,9,9,1
"""


class Profile(unittest.TestCase):
    def call(self, *arguments):
        done = subprocess.run([sys.executable, SCRIPT, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        return done.returncode, done.stdout, done.stderr

    def test_samples_belong_to_the_stage_of_their_outermost_function(self):
        self.assertEqual(profile.read_samples(SAMPLES.splitlines()), {
            "1 collisions": {"closest": 2}, "5 failsafe": {"[unknown]": 1}, "outside of steps": {"parse_json": 1}})
        self.assertEqual(profile.stage_of(["memcpy", "flotilla::Stepper::commit"]), "rest of the step")

    def test_names_are_those_that_the_source_has(self):
        for name, wanted in [("flotilla::(anonymous namespace)::run<flotilla::Vec<8>, 3>", "run"),
                             ("flotilla::Clusters::evolve", "Clusters::evolve"),
                             ("flotilla::certify(flotilla::StepView const&, flotilla::PairBook&, flotilla::Team&)::{lambda(unsigned long, int)#1}", "certify::lambda")]:
            self.assertEqual(profile.plain(name), wanted)

    def test_stages_are_called_what_functions_of_the_source_are(self):
        sources = ""
        for folder, _, names in os.walk(os.path.join(ROOT, "src")):
            for name in names:
                if name.endswith((".hpp", ".cpp")):
                    with open(os.path.join(folder, name), encoding="utf-8") as file:
                        sources += file.read()
        for name, _ in profile.STAGES:
            self.assertRegex(sources, rf"\b{name}\(", name)

    def test_rows_of_a_trace_add_up(self):
        self.assertEqual(profile.read_rows(ROWS.splitlines()), {
            "rest of the step": {"start pairs": 0.5, "between sections": 0.125},
            "stage7_static_contact": {"between sections": 0.75, "small islands": 4.0}})

    def test_the_table_says_what_it_leaves_out(self):
        lines = profile.report({"a stage": {"one": 6, "two": 3, "three": 1}}, 0.5, "ms a step", 1)
        self.assertEqual([line.split() for line in lines[1:]], [
            ["a", "stage", "100.0", "%", "5.000"], ["one", "60.0", "%", "3.000"], ["2", "more", "40.0", "%", "2.000"],
            ["all", "100.0", "%", "5.000"]])
        self.assertEqual(profile.report({}, 1, "", 1), ["nothing was recorded"])

    def test_profiles_a_run(self):
        for way in ["trace"] + (["perf"] if profile.perf_works() else []):
            code, out, errors = self.call("falling-boats", "--steps", "3", "--from", "2", "--with", way, "--flotilla", COMMAND)
            self.assertEqual(code, 0, errors)
            lines = out.splitlines()
            self.assertEqual(lines[0], f"falling-boats, steps 3 to 5, one thread, by {way}")
            self.assertRegex(lines[-1], r"^all +100\.0 % +\d+\.\d{3}$")
            if way == "trace":
                self.assertTrue(any(re.match("stage1_collisions ", line) for line in lines), out)

    def test_says_what_is_wrong(self):
        code, out, _ = self.call("--help")
        self.assertEqual(code, 0)
        self.assertTrue(out.startswith("Says where the time of a run goes"), out)
        self.assertEqual(self.call("--steps", "0")[0], 2)
        self.assertEqual(self.call("--unknown")[0], 2)
        code, _, errors = self.call("no-such-scene", "--flotilla", COMMAND)
        self.assertEqual(code, 1)
        self.assertIn("no-such-scene", errors)


if __name__ == "__main__":
    COMMAND = os.path.abspath(sys.argv.pop(1))
    unittest.main()
