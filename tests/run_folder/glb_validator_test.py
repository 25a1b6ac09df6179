#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Runs the Khronos glTF validator on exported GLB files, and on one that was damaged on purpose.

usage: glb_validator_test.py FLOTILLA
Needs node and the npm package gltf-validator where node finds it (npm install gltf-validator in a folder, NODE_PATH=folder/node_modules).
Prints every error and warning. Exit code: 0 as expected, 1 not, 77 skipped: node or the validator is not installed.
"""
import json
import os
import shutil
import subprocess
import sys
import tempfile

VALIDATE = """
const validator = require('gltf-validator');
validator.validateBytes(new Uint8Array(require('fs').readFileSync(process.argv[1])))
    .then(report => console.log(JSON.stringify({version: validator.version(), ...report})));
"""


def node(script, *arguments):
    return subprocess.run(["node", "-e", script, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def validate(path):
    """The validator's report; errors and warnings are printed."""
    result = node(VALIDATE, path)
    if result.returncode != 0:
        sys.exit("FAILED: the validator gave up: " + result.stderr)
    report = json.loads(result.stdout)
    for message in report["issues"]["messages"]:
        if message["severity"] < 2:
            print(("error" if message["severity"] == 0 else "warning") + f": {message['pointer']}: {message['message']}")
    return report


def export_glb(flotilla, folder, name, bodies, steps):
    def call(*arguments):
        return subprocess.run([flotilla, *arguments], check=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True).stdout

    scene, run, file = (f"{folder}/{name}.{suffix}" for suffix in ("json", "run", "glb"))
    with open(scene, "w", encoding="utf-8") as out:
        out.write(call("scene", name, "--bodies", str(bodies)))
    call("run", scene, "--steps", str(steps), "--output", run, "--quiet")
    call("export", run, "--format", "glb", "--output", file)
    return file


def damage(path):
    """Makes an accessor longer than its data, with a number of as many digits."""
    with open(path, "rb") as file:
        data = file.read()
    before = data.find(b'"count":')
    digit = before + len(b'"count":')
    with open(path, "wb") as file:
        file.write(data[:digit] + b"9" + data[digit + 1:])


def main(flotilla):
    if not shutil.which("node"):
        print("skipped: node is not installed")
        return 77
    if node("require('gltf-validator')").returncode != 0:
        print("skipped: node does not find the npm package gltf-validator (NODE_PATH)")
        return 77
    failed = False
    with tempfile.TemporaryDirectory() as folder:
        for name, bodies, steps in (("boats-in-bowl", 22, 30), ("stack", 5, 0)):
            file = export_glb(flotilla, folder, name, bodies, steps)
            report = validate(file)
            issues = report["issues"]
            print(f"{name}, {bodies} bodies, {steps} steps, {os.path.getsize(file)} bytes: {issues['numErrors']} errors, "
                  f"{issues['numWarnings']} warnings, {issues['numInfos']} infos (validator {report['version']})")
            failed = failed or issues["numErrors"] + issues["numWarnings"] > 0
        damage(file)
        found = validate(file)["issues"]["numErrors"]
        print(f"a file with a wrong count: {found} errors")
    return 1 if failed or found == 0 else 0


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1]))
