# SPDX-License-Identifier: MIT
"""pip installs the package of the build tree into a folder of its own, and it works there."""
import os
import pathlib
import subprocess
import sys

import pytest

ROOT = pathlib.Path(__file__).parents[2]
PROGRAM = """
import flotilla
world = flotilla.World(flotilla.make_scene("stack", bodies=3), threads=1)
world.step(3)
print(flotilla.__file__)
"""


def test_the_wheel_holds_a_package_that_works(tmp_path):
    if subprocess.run([sys.executable, "-m", "pip", "--version"], capture_output=True).returncode != 0:
        pytest.skip("pip is not installed (Debian package python3-pip)")
    subprocess.run([sys.executable, "-m", "pip", "install", "--no-build-isolation", "--no-deps", "--no-index",
                    "--target", tmp_path / "site", "--config-settings",
                    f"build-dir={os.environ['FLOTILLA_BUILD_DIR']}", ROOT], check=True)
    environment = dict(os.environ, PYTHONPATH=str(tmp_path / "site"))
    says = subprocess.run([sys.executable, "-c", PROGRAM], check=True, capture_output=True, text=True, env=environment,
                          cwd=tmp_path).stdout
    assert says.startswith(str(tmp_path / "site"))
    installed = {path.name for path in (tmp_path / "site" / "flotilla").iterdir()}
    sources = {path.name for path in (ROOT / "src" / "python" / "flotilla").iterdir()} - {"__pycache__"}
    assert sources <= installed
    info = next((tmp_path / "site").glob("flotilla-*.dist-info"))
    assert "License: MIT" in (info / "METADATA").read_text() and (info / "NOTICE.txt").exists()


def test_the_source_archive_holds_the_sources(tmp_path):
    sys.path.insert(0, str(ROOT / "src" / "python"))
    import build_backend
    if not (ROOT / ".git").exists():
        pytest.skip("not a checkout")
    import tarfile
    with tarfile.open(tmp_path / build_backend.build_sdist(tmp_path)) as archive:
        names = {name.split("/", 1)[1] for name in archive.getnames() if "/" in name}
    assert {"CMakeLists.txt", "include/flotilla/world.hpp"} <= names
