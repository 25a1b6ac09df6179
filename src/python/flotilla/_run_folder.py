# SPDX-License-Identifier: MIT
"""Run folders as arrays."""
from __future__ import annotations

import csv
import os
from typing import Any

import numpy
from numpy.typing import NDArray

from . import _core
from ._errors import IoError
from ._typing import Path

_QUANTITIES = {"time", "residual", "energy", "min_distance", "kinetic_energy", "energy_removed", "lift"}
_QUANTITY_PARTS = ("_ms", "momentum_x", "momentum_y", "momentum_z")


def _column(name: str, texts: list[str]) -> NDArray[Any]:
    """As the file's own type: hashes are hexadecimal, an unknown distance is empty."""
    if name.endswith("_hash"):
        return numpy.array([int(text, 16) for text in texts], dtype=numpy.uint64)
    if name in _QUANTITIES or name.endswith(_QUANTITY_PARTS):
        return numpy.array([float(text) if text else numpy.inf for text in texts])
    return numpy.array([int(text) for text in texts], dtype=numpy.int64)


def read_steps(folder: Path) -> dict[str, NDArray[Any]]:
    """The columns of a run's steps.csv by name, an array of shape (steps) each: int64 counts, float64 quantities,
    uint64 hashes. Of a run that is still going the rows that are whole."""
    path = os.path.join(os.fspath(folder), "steps.csv")
    try:
        with open(path, newline="", encoding="utf-8") as file:
            text = file.read()
    except OSError as error:
        raise IoError(f"{path}: {error.strerror}") from error
    whole = text[: text.rfind("\n") + 1]
    header, *rows = csv.reader(whole.splitlines()) if whole else [[]]
    if any(len(row) != len(header) for row in rows):
        raise IoError(f"{path}: a row has not as many fields as there are columns")
    return {name: _column(name, [row[k] for row in rows]) for k, name in enumerate(header)}


class RunFolder:
    """The folder of a run, finished or not. What is read is not kept: every call looks at the folder anew."""

    def __init__(self, folder: Path) -> None:
        self.path: str = os.fspath(folder)
        self.summary()

    def summary(self) -> _core.RunSummary:
        """What the folder holds, and where it comes from."""
        return _core.summarize_run(self.path)

    def steps(self) -> dict[str, NDArray[Any]]:
        """As read_steps."""
        return read_steps(self.path)

    def frames(self, *, first: int = 0, last: int | None = None, every: int = 1) -> _core.Frames:
        """As read_frames."""
        return _core.read_frames(self.path, first=first, last=last, every=every)

    def verify(self, **options: Any) -> _core.VerifyReport:
        """As flotilla.verify."""
        return _core.verify(self.path, **options)

    def __repr__(self) -> str:
        return f"RunFolder({self.path!r})"
