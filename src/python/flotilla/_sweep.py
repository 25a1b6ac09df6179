# SPDX-License-Identifier: MIT
"""Campaigns whose runs are processes of their own: what crashes or fills the memory is that run alone."""
from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from typing import Any, Callable, Iterable, Mapping, Sequence

from . import _core
from ._errors import BrokenPromise, InputError, IoError, OverlapError, ScriptError
from ._typing import Path, SettingValue

_EXIT_CODES = ((InputError, 2), (BrokenPromise, 3), (OverlapError, 4), (IoError, 5), (ScriptError, 7))


def _make_run(member: dict[str, Any]) -> int:
    """The body of a member's process: as `flotilla run`, with its exit codes."""
    try:
        totals = _core.run(member["scene"], member["folder"], steps=member["steps"], preset=member["preset"],
                           settings=member["settings"], frame_every=member["frame_every"],
                           threads=member["threads"], resume=True)
    except Exception as error:  # every failure is the member's, with the command's exit code
        print(error, file=sys.stderr)
        return next((code for kind, code in _EXIT_CODES if isinstance(error, kind)), 1)
    return 0 if totals.complete else 6


def _member_process(member: _core.SweepMember) -> tuple[int, str, float]:
    """Makes a run in a process of its own: (exit code, reason, CPU seconds)."""
    task = {"scene": str(member.scene), "folder": str(member.folder), "steps": member.steps, "preset": member.preset,
            "settings": member.settings, "frame_every": member.frame_every, "threads": member.threads}
    package = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
    environment = dict(os.environ, PYTHONPATH=os.pathsep.join(filter(None, [package, os.environ.get("PYTHONPATH")])))
    with open(member.log, "wb") as log:
        process = subprocess.Popen([sys.executable, "-m", "flotilla._sweep"], stdin=subprocess.PIPE, stdout=log,
                                   stderr=log, env=environment)
        with process.stdin as stdin:
            stdin.write(json.dumps(task).encode())
        _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    cpu = usage.ru_utime + usage.ru_stime
    if process.returncode < 0:
        return 1, "ended by signal " + signal.Signals(-process.returncode).name, cpu
    with open(member.log, encoding="utf-8", errors="replace") as log:
        lines = log.read().splitlines()
    return process.returncode, lines[-1] if process.returncode and lines else "", cpu


def _text(value: SettingValue) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)


def sweep(scenes: Path | Sequence[Path], output: Path, *, vary: Mapping[str, Iterable[SettingValue]], bodies: int = 0,
          preset: str = "balanced", settings: Mapping[str, SettingValue] | None = None, reference: str = "",
          metrics: Iterable[str] = (), steps: int | None = None, duration: float = 10.0, threads: int = 1,
          jobs: int = 0, overwrite: bool = False, resume: bool = False,
          run: Callable[[_core.SweepMember], tuple[int, str, float]] | None = None,
          progress: Callable[[int, int, str], object] | None = None,
          note: Callable[[str], object] | None = None) -> _core.SweepReport:
    """Runs a problem with every combination of the values of some settings and says what each costs, how far it is from
    a reference, and what to change first: a SweepReport, and sweep.csv, members.csv, sweep.json and sweep.html in the
    folder `output`.

    scenes: a scene file or a name of the library, or a list of such: several starts of one problem. vary: values by
    key, {"preset": ["preview", "balanced"], "dt": [0.04, 0.02], "seed": [1, 2, 3]}. bodies: of scenes of the library.
    settings: of every run. reference: a preset, or empty. metrics: names of sweep_metrics, the error of the front
    first; empty: all. steps or duration (s): of every run. threads: of each run; jobs: runs at a time, 0: as many as
    have cores. run(member) makes a run and returns (exit code, reason, CPU seconds); by default a process of Python
    does.
    """
    if isinstance(scenes, (str, os.PathLike)):
        scenes = [scenes]
    return _core._sweep([os.fspath(scene) for scene in scenes], os.fspath(output),
                       [(key, [_text(value) for value in values]) for key, values in vary.items()], bodies, preset,
                       [(key, _text(value)) for key, value in (settings or {}).items()], reference, list(metrics),
                       -1 if steps is None else steps, duration, threads, jobs, overwrite, resume,
                       run or _member_process, progress, note)


if __name__ == "__main__":
    sys.exit(_make_run(json.load(sys.stdin)))
