# SPDX-License-Identifier: MIT
"""Pictures of what is in memory as well as of files."""
from __future__ import annotations

import os
import tempfile
from typing import Any

from . import _core
from ._typing import Path


def picture(source: _core.World | _core.Scene | Path, output: Path, **options: Any) -> _core.PictureReport:
    """Writes a PNG and returns a PictureReport. source: a World as it stands, a Scene, a scene file, or a run folder.

    Options: frame (of a run folder; default the last one), width, height (pixels), supersampling, azimuth, elevation,
    field_of_view (degrees), zoom, target (m, shape (3)), camera_frame, sun_samples, sky_samples, outlines. The same
    input gives the same bytes.
    """
    if isinstance(source, _core.World):
        source = source.scene_now()
    if not isinstance(source, _core.Scene):
        return _core._write_picture(source, output, **options)
    with tempfile.TemporaryDirectory(prefix="flotilla-") as folder:
        file = os.path.join(folder, "scene.json")
        _core.write_scene(source, file)
        return _core._write_picture(file, output, **options)
