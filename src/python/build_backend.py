# SPDX-License-Identifier: MIT
"""Makes the wheel of the package with CMake alone (PEP 517), so that nothing has to be downloaded for it.

`pip install --no-build-isolation .` builds library and module in build/wheel-TAG, where a second build is quick;
`-C build-dir=DIR`, with pip 23 `--config-settings build-dir=DIR`, takes them from a build tree that is there.
"""
import base64
import hashlib
import os
import re
import subprocess
import sys
import sysconfig
import tempfile
import zipfile

_ROOT = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", ".."))
_CMAKE = os.environ.get("CMAKE_COMMAND", "cmake")
_DESTINATION = "package"


def _read(*path):
    with open(os.path.join(_ROOT, *path), encoding="utf-8") as file:
        return file.read()


def _version():
    return re.search(r"^project\(flotilla VERSION (\S+)", _read("CMakeLists.txt"), re.MULTILINE)[1]


def _tag():
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    return f"{python}-{python}-{re.sub('[-.]', '_', sysconfig.get_platform())}"


def _metadata():
    return "\n".join(["Metadata-Version: 2.1", "Name: flotilla", f"Version: {_version()}",
                      "Summary: Rigid bodies that never intersect, surfaces without thickness among them",
                      "License: MIT", "Requires-Python: >=3.9", "Requires-Dist: numpy",
                      "Description-Content-Type: text/markdown", "",
                      _read("src", "python", "README.md")])


def _build():
    """Library and module; the folder of the build."""
    folder = os.path.join(_ROOT, "build", f"wheel-{_tag()}")
    subprocess.check_call([_CMAKE, "-S", _ROOT, "-B", folder, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
                           "-DFLOTILLA_PYTHON=ON", f"-DPython_EXECUTABLE={sys.executable}",
                           "-DFLOTILLA_BUILD_TESTS=OFF", "-DFLOTILLA_BUILD_BENCH=OFF", "-DFLOTILLA_BUILD_CLI=OFF"])
    subprocess.check_call([_CMAKE, "--build", folder, "--target", "flotilla_python"])
    return folder


def _files(build):
    """Name in the wheel and content of every file of the package."""
    with tempfile.TemporaryDirectory() as prefix:
        subprocess.check_call([_CMAKE, "--install", build, "--component", "python", "--prefix", prefix])
        for folder, subfolders, names in os.walk(prefix):
            subfolders.sort()
            for name in sorted(names):
                path = os.path.join(folder, name)
                with open(path, "rb") as file:
                    yield path[path.rindex(os.sep + "flotilla" + os.sep) + 1 :], file.read()


def _record_line(name, content):
    digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
    return f"{name},sha256={digest},{len(content)}"


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    build = os.path.join(_ROOT, (config_settings or {}).get("build-dir") or _build())
    stem = f"flotilla-{_version()}"
    info = f"{stem}.dist-info"
    files = dict(_files(build))
    files[f"{info}/METADATA"] = _metadata().encode()
    wheel_info = f"Wheel-Version: 1.0\nGenerator: flotilla\nRoot-Is-Purelib: false\nTag: {_tag()}\n"
    files[f"{info}/WHEEL"] = wheel_info.encode()
    for name in ("LICENSE", "scripts/cmake/NOTICE.txt"):
        files[f"{info}/{os.path.basename(name)}"] = _read(*name.split("/")).encode()
    record = [_record_line(name, content) for name, content in files.items()]
    files[f"{info}/RECORD"] = "\n".join([*record, f"{info}/RECORD,,", ""]).encode()
    wheel = f"{stem}-{_tag()}.whl"
    with zipfile.ZipFile(os.path.join(wheel_directory, wheel), "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            archive.writestr(zipfile.ZipInfo(name, (2000, 1, 1, 0, 0, 0)), content, zipfile.ZIP_DEFLATED)
    return wheel


def build_sdist(sdist_directory, config_settings=None):
    """What is committed, as the tag of a version has it."""
    stem = f"flotilla-{_version()}"
    archive = os.path.join(os.path.abspath(sdist_directory), f"{stem}.tar.gz")
    subprocess.check_call(["git", "-C", _ROOT, "archive", f"--prefix={stem}/", f"--output={archive}", "HEAD"])
    return os.path.basename(archive)
