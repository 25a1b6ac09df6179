# SPDX-License-Identifier: MIT
"""Scenes from meshes."""
from __future__ import annotations

from typing import Iterable, Mapping

import numpy
from numpy.typing import ArrayLike

from . import _core
from ._errors import InputError
from ._typing import MeshLike, SettingValue


def _rows(name: str, values: ArrayLike | None, default: tuple[float, ...], count: int) -> numpy.ndarray:
    """One row for each body, with as many columns as the default has."""
    if values is None:
        return numpy.tile(default, (count, 1))
    rows = numpy.asarray(values, dtype=float)
    if rows.shape != (count, len(default)):
        raise InputError(f"{name} must have shape ({count}, {len(default)}), not {rows.shape}")
    return rows


def scene_from_meshes(meshes: Iterable[MeshLike], positions: ArrayLike | None = None,
                      rotations: ArrayLike | None = None, *, static: Iterable[int] = (), surface_density: float = 10.0,
                      gravity: ArrayLike = (0, 0, -9.8), preset: str = "balanced",
                      settings: Mapping[str, SettingValue] | None = None) -> _core.Scene:
    """A Scene with a body for each mesh. meshes: objects with .vertices (n, 3) in m and .faces (m, 3), or pairs of such
    arrays; an object that is there several times is one shape. positions: m, shape (bodies, 3), and rotations: unit
    quaternions w x y z, shape (bodies, 4), default to none. static: indices of bodies that never move. surface_density:
    kg/m^2 of all meshes."""
    meshes = list(meshes)
    where = _rows("positions", positions, (0, 0, 0), len(meshes))
    turned = _rows("rotations", rotations, (1, 0, 0, 0), len(meshes))
    fixed = set(static)
    if not fixed <= set(range(len(meshes))):
        raise InputError(f"static: there are bodies 0 to {len(meshes) - 1} only, not {sorted(fixed)}")
    scene = _core.Scene(gravity=gravity, preset=preset, settings=settings)
    shapes: dict[int, int] = {}
    for k, mesh in enumerate(meshes):
        if id(mesh) not in shapes:
            shapes[id(mesh)] = scene.add_shape(mesh, surface_density=surface_density)
        scene.add_body(shapes[id(mesh)], type="static" if k in fixed else "dynamic",
                       position=where[k], rotation=turned[k])
    return scene
