# SPDX-License-Identifier: MIT
"""The notebook runs, its pictures are there, and what it shows is true."""
import json
import pathlib
import sys
import types

import numpy
import pytest

EXAMPLES = pathlib.Path(__file__).parents[2] / "scripts" / "examples"
PNG = b"\x89PNG\r\n\x1a\n"


def test_the_notebook_runs_from_the_first_cell_to_the_last(tmp_path, monkeypatch):
    matplotlib = pytest.importorskip("matplotlib", reason="python3-matplotlib is not installed")
    matplotlib.use("Agg")
    shown = []
    display = types.ModuleType("IPython.display")  # what shows a picture in a notebook is not needed to make it
    display.Image = shown.append
    shell = types.ModuleType("IPython")
    shell.get_ipython = lambda: None
    monkeypatch.setitem(sys.modules, "IPython", shell)
    monkeypatch.setitem(sys.modules, "IPython.display", display)
    monkeypatch.setenv("BODIES", "12")
    monkeypatch.setenv("STEPS", "90")
    monkeypatch.setenv("FLOTILLA_NUM_THREADS", "1")
    monkeypatch.chdir(tmp_path)
    notebook = json.loads((EXAMPLES / "pile.ipynb").read_text())
    names = {}
    for cell in notebook["cells"]:
        if cell["cell_type"] == "code":
            assert cell["outputs"] == [] and cell["execution_count"] is None
            exec(compile("".join(cell["source"]), cell["id"], "exec"), names)
    assert shown == ["pile.png"]
    for picture in ("pile.png", "forces.png", "energy.png"):
        assert (tmp_path / picture).read_bytes().startswith(PNG)
    assert names["carried"] == pytest.approx(names["weight"], rel=0.05)
    assert names["growth"].max() <= 1e-9 * numpy.ptp(names["energy"])
