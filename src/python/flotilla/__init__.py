# SPDX-License-Identifier: MIT
"""Rigid bodies that never intersect: triangle meshes, shells without thickness, frame-rate time steps, the same bits at
any number of threads.

    import flotilla
    world = flotilla.World(flotilla.make_scene("household", bodies=12))
    world.step(48)                      # throws rather than leave two bodies intersecting
    print(world.positions)              # m, shape (bodies, 3)

SI units throughout; rotations are unit quaternions w x y z; positions are those of the meshes' own origins.
"""
from . import _core
from ._core import *  # everything that is compiled and public
from ._enums import ClusterState, StepWarning
from ._errors import (BodyPair, BrokenPromise, Error, InputError, IoError, OverlapError, OverlapPair, Problem,
                      ScriptError, StepCancelled)
from ._meshes import scene_from_meshes
from ._picture import picture
from ._run_folder import RunFolder, read_steps
from ._sweep import sweep

__version__ = _core.build_info()["version"]
__all__ = sorted(
    {name for name in dir(_core) if not name.startswith("_")}
    | {"BodyPair", "BrokenPromise", "ClusterState", "Error", "InputError", "IoError", "OverlapError", "OverlapPair",
       "Problem", "RunFolder", "ScriptError", "StepCancelled", "StepWarning", "picture", "read_steps",
       "scene_from_meshes", "sweep"})
