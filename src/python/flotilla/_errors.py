# SPDX-License-Identifier: MIT
"""The exceptions of the library, with their data."""
from __future__ import annotations

from typing import Iterable, NamedTuple


class Problem(NamedTuple):
    """One thing that is wrong with an input: a JSON pointer such as "/bodies/3/position", and the reason."""

    where: str
    reason: str


class BodyPair(NamedTuple):
    """Two bodies by index and name."""

    a: int
    b: int
    name_a: str
    name_b: str


class OverlapPair(NamedTuple):
    """Two bodies that intersect at the start, and the number of their triangle pairs that do."""

    a: int
    b: int
    name_a: str
    name_b: str
    triangle_pairs: int


class Error(RuntimeError):
    """What the library throws; the message names what is concerned and why, one line each."""


class InputError(Error, ValueError):
    """Input that the caller must correct: a file, an option, a scene, an index. `problems` has all of them where the
    input is a scene; otherwise the message says everything."""

    def __init__(self, message: str, problems: Iterable[tuple[str, str]] = ()) -> None:
        super().__init__(message)
        self.problems = tuple(Problem(*problem) for problem in problems)


class IoError(Error):
    """A file or folder that cannot be read or written."""


class OverlapError(Error):
    """Bodies intersect at the start: `pairs`, sorted by bodies."""

    def __init__(self, message: str, pairs: Iterable[tuple[int, int, str, str, int]] = ()) -> None:
        super().__init__(message)
        self.pairs = tuple(OverlapPair(*pair) for pair in pairs)


class ScriptError(Error):
    """A script cannot make step `step` in full, and the scene asks for an error then. `pairs`: scripted body and one
    that it would crush. The World stands where the step began."""

    def __init__(self, message: str, step: int = 0, pairs: Iterable[tuple[int, int, str, str]] = ()) -> None:
        super().__init__(message)
        self.step = step
        self.pairs = tuple(BodyPair(*pair) for pair in pairs)


class StepCancelled(Error):
    """An observer ended the step (World.set_observer). The World stands where the step began."""


class BrokenPromise(Error):
    """The end of step `step` could not be proved free of intersections: a fault of the library. `pair` has no proof."""

    def __init__(self, message: str, step: int = 0, pair: tuple[int, int, str, str] = (-1, -1, "", "")) -> None:
        super().__init__(message)
        self.step = step
        self.pair = BodyPair(*pair)
