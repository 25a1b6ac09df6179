# SPDX-License-Identifier: MIT
"""Runs the flotilla command and reads what it wrote. SI units."""
import csv
import json
import math
import os
import re
import subprocess


class Failed(Exception):
    """A command ended with another exit code than expected."""


class Flotilla:
    """The command, and a folder for everything that it writes."""

    def __init__(self, command, folder, threads):
        self.command, self.folder, self.threads = command, folder, threads
        self.commit = None  # of the command, as its first run says
        os.makedirs(folder, exist_ok=True)

    def call(self, *arguments, expect=(0,)):
        done = subprocess.run([self.command, *map(str, arguments)], capture_output=True, text=True)
        if done.returncode not in expect:
            raise Failed(f"flotilla {' '.join(map(str, arguments))}: exit code {done.returncode}\n{done.stdout}{done.stderr}")
        return done.stdout

    def scene(self, name, bodies=0, seed=1, edit=None):
        """The path of a library scene's file. edit(scene) may change it, a dict, before it is written."""
        text = self.call("scene", name, "--seed", seed, *(["--bodies", bodies] if bodies else []))
        if edit:
            scene = json.loads(text)
            edit(scene)
            text = json.dumps(scene)
        path = os.path.join(self.folder, f"{name}.json")
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        return path

    def verdict(self, *what):
        """(frames checked, faults) of flotilla verify, however it ends."""
        text = self.call("verify", "--quiet", *what, expect=(0, 3))
        number = lambda kind: int(re.search(kind + r": +(\d+)", text).group(1))
        return number("frames checked"), sum(map(number, ("intersecting pairs", "pairs passing through", "pairs not proved",
                                                          "bad poses")))

    def run(self, scene, steps, label, settings=None, verify=True, options=()):
        """Runs `scene` (a path), verifies it frame by frame and in between, and returns a Run."""
        folder = os.path.join(self.folder, label)
        arguments = [word for key, value in (settings or {}).items() for word in ("--set", f"{key}={value}")]
        text = self.call("run", scene, "--output", folder, "--overwrite", "--steps", steps, "--threads", self.threads,
                         *arguments, *options)
        if self.commit is None:
            with open(os.path.join(folder, "run.json"), encoding="utf-8") as file:
                self.commit = json.load(file)["commit"]
        return Run(self, folder, verify, float(re.search(r"peak memory: ([\d.]+) MiB", text).group(1)))


class Run:
    """A finished run."""

    def __init__(self, flotilla, folder, verify, peak_mib):
        self.flotilla, self.folder, self.peak_mib = flotilla, folder, peak_mib
        with open(os.path.join(folder, "steps.csv"), encoding="utf-8") as file:
            self.steps = list(csv.DictReader(file))
        self.frames_verified = self.intersections = 0
        if verify:
            self.frames_verified, self.intersections = flotilla.verdict(self.folder)

    def state_mb(self):
        """Geometry and state, as the run folder holds them: the meshes and the last checkpoint, MB."""
        files = ["meshes.h5", max(name for name in os.listdir(self.folder) if name.startswith("checkpoint-"))]
        return sum(os.path.getsize(os.path.join(self.folder, name)) for name in files) / 1e6

    def column(self, name):
        return [float(row[name] or "inf") for row in self.steps]

    def frames(self):
        """{frame: {body name: State}} of the whole run."""
        return frames_of(self.flotilla.call("export", self.folder, "--format", "csv").splitlines())

    def picture(self, path, frame=None):
        self.flotilla.call("picture", self.folder, "--output", path, "--width", 960, "--height", 600,
                           *(["--frame", frame] if frame is not None else []))
        make_smaller(path)


def make_smaller(path):
    """Of a picture a third, by a palette of 255 colours; where Pillow is missing it stays as it is."""
    try:
        from PIL import Image
    except ImportError:
        return
    with Image.open(path) as image:
        image.convert("RGB").quantize(255, dither=Image.Dither.FLOYDSTEINBERG).save(path, optimize=True)


class BaselineRun:
    """A scene run by bench/baseline, the method of reference [15]. Its faults are part of what it shows, not failures."""

    def __init__(self, flotilla, command, scene, steps, label, *options):
        path = os.path.join(flotilla.folder, label + ".csv")
        done = subprocess.run([command, scene, "--steps", str(steps), "--output", path, *map(str, options)], capture_output=True,
                              text=True)
        if done.returncode != 0:
            raise Failed(f"{command} {scene}: exit code {done.returncode}\n{done.stdout}{done.stderr}")
        with open(path, encoding="utf-8", newline="") as file:
            self._frames = frames_of(file)
        self.faults = flotilla.verdict(scene, "--poses", path)[1]

    def frames(self):
        return self._frames


def frames_of(lines):
    """{frame: {body name: State}} of a trajectory in the CSV export format."""
    out = {}
    for row in csv.DictReader(lines):
        out.setdefault(int(row["frame"]), {})[row["name"]] = State(row)
    return out


class State:
    """A body in a frame: p, v, w as triples, q as (w, x, y, z)."""

    def __init__(self, row):
        self.time = float(row["time"])
        triple = lambda k: tuple(float(row[k + axis]) for axis in "xyz")
        self.p, self.v, self.w = triple("p"), triple("v"), triple("w")
        self.q = (float(row["qw"]), *triple("q"))

    def axis_z(self):
        """The body's own z axis in the world."""
        w, x, y, z = self.q
        return 2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)

    def speed(self):
        return math.hypot(*self.v)


def distance(a, b):
    """Of two states' origins, m."""
    return math.dist(a.p, b.p)


def mean(values):
    values = list(values)
    return sum(values) / len(values)
