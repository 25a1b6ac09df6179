# SPDX-License-Identifier: MIT
"""The examples and the sample of the module's page run, and what they print and write is what they promise; small, so
that all of them together take seconds."""
import os
import pathlib
import re
import subprocess
import sys

import numpy
import pytest

ROOT = pathlib.Path(__file__).parents[2]
EXAMPLES = ROOT / "scripts" / "examples"
PNG = b"\x89PNG\r\n\x1a\n"


def run(name, *arguments, folder):
    words = [sys.executable, str(EXAMPLES / name), *map(str, arguments)]
    return subprocess.run(words, check=True, capture_output=True, text=True, cwd=folder,
                          env=dict(os.environ, FLOTILLA_NUM_THREADS="1")).stdout


def columns(text, rows):
    """The numbers of the last lines of a table."""
    return numpy.array([[float(word) for word in line.split()] for line in text.splitlines()[-rows:]])


def test_bin_filling_writes_proved_piles(tmp_path):
    says = run("bin_filling.py", "--bodies", 6, "--piles", 2, "--duration", 1.5, "--width", 96, "--verify", "--output",
               tmp_path / "piles", folder=tmp_path)
    assert says.count("6 of 6 bodies above the floor") == 2
    for seed in range(2):
        with numpy.load(tmp_path / "piles" / f"pile-{seed}.npz") as pile:
            assert pile["positions"].shape == (7, 3) and pile["rotations"].shape == (7, 4) and len(pile["names"]) == 7
            assert numpy.linalg.norm(pile["rotations"], axis=1) == pytest.approx(1, abs=1e-12)
        assert (tmp_path / "piles" / f"pile-{seed}.png").read_bytes().startswith(PNG)


def test_cups_have_a_density(tmp_path):
    says = run("packing_density.py", "--cups", 4, "--width", 0.2, "--seeds", 1, "--tapers", 1.5, "--duration", 1,
    "--picture", "heap.png", folder=tmp_path)
    taper, density, spread = columns(says, 1)[0]
    assert taper == 1.5 and 0.05 < density < 2 and spread == 0
    assert (tmp_path / "heap.png").read_bytes().startswith(PNG)


def test_every_ring_of_the_chain_pulls_what_hangs_below(tmp_path):
    links = 4
    table = columns(run("chain.py", "--links", links, "--duration", 3, folder=tmp_path), links - 1)
    assert table[:, 2] == pytest.approx(table[:, 3], rel=0.02)
    assert (numpy.diff(table[:, 1]) < -0.05).all()  # no ring left the one above


def test_the_feeder_bowl_carries_parts_forward(tmp_path):
    says = run("feeder_bowl.py", "--parts", 1, "--duration", 0.24, folder=tmp_path)
    assert float(re.search(r"mean (\S+) mm/s", says)[1]) > 1


def test_the_sample_of_the_page_runs(tmp_path, monkeypatch, plate, capsys):
    page = (ROOT / "src" / "python" / "README.md").read_text()
    sample = re.search(r"```python\n(.*?)```", page, re.DOTALL)[1]
    monkeypatch.chdir(tmp_path)
    # What it takes for given: meshes and where they stand. Of the run half a second will do.
    exec(sample.replace("duration=5", "duration=0.5"), {"meshes": [plate, plate], "positions": [(0, 0, 1), (0, 0, 2)]})
    assert (tmp_path / "household.png").read_bytes().startswith(PNG)
    assert capsys.readouterr().out.splitlines()[-1] == "True (13, 2, 3)"
