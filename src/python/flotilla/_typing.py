# SPDX-License-Identifier: MIT
"""Types of what callers may give."""
import os
from typing import TYPE_CHECKING, Any, Mapping, Protocol, Sequence, Tuple, Union

from numpy.typing import ArrayLike

if TYPE_CHECKING:
    from ._core import Edit, Scene

Path = Union[str, "os.PathLike[str]"]
SettingValue = Union[str, bool, int, float]


class Mesh(Protocol):
    """Vertices, m, shape (n, 3), and the three vertices of each face, shape (m, 3)."""

    vertices: Any
    faces: Any


MeshLike = Union[Mesh, Tuple[ArrayLike, ArrayLike]]
KeyframeLike = Union[Tuple[float, ArrayLike], Tuple[float, ArrayLike, ArrayLike]]  # time, position[, rotation]
EditsLike = Union[Sequence["Edit"], Path, Mapping[str, Any]]  # a list, a file, JSON text, or a dict as such text has
SceneLike = Union["Scene", Path, Mapping[str, Any]]  # a Scene, a file, JSON text, or a dict as such text has
