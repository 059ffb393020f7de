"""What pip calls (https://peps.python.org/pep-0517/) to make a wheel of what CMake builds, and an archive of the sources.

The wheel is the installation without the programs, whose commands the module has in itself: the package, and what it
looks for in the prefix (`touchstone._programs`). Its libraries are the system's: it is for the Python and the distribution
that it was made on, and says so in its tag (linux_x86_64, no manylinux).

    pip wheel --no-deps --no-build-isolation .
    pip wheel --no-deps --no-build-isolation --config-settings build-folder=build/package .   # a build that is there
"""

import os
import shutil
import subprocess
import sys
import sysconfig
import tempfile
from pathlib import Path
from typing import Mapping, Optional

ROOT = Path(__file__).resolve().parents[2]
VERSION = (ROOT / "VERSION").read_text().strip()
_PYTHON = f"cp{sys.version_info.major}{sys.version_info.minor}"
_TAG = f"{_PYTHON}-{_PYTHON}-{sysconfig.get_platform().replace('-', '_')}"


def _run(*command: object) -> None:
    subprocess.run([str(word) for word in command], check=True, cwd=ROOT, stdout=sys.stderr)


def build_wheel(wheel_directory: str, config_settings: Optional[Mapping[str, str]] = None,
                metadata_directory: Optional[str] = None) -> str:
    built = (config_settings or {}).get("build-folder")
    if built is None:
        built = "build/package"
        _run("cmake", "--preset", "package")
        _run("cmake", "--build", "--preset", "package")
    with tempfile.TemporaryDirectory() as scratch:
        prefix, tree = Path(scratch, "prefix"), Path(scratch, "tree")
        for component in ("python", "program"):
            _run("cmake", "--install", built, "--component", component, "--prefix", prefix, "--strip")
        shutil.move(prefix / "lib/python3/dist-packages", tree)
        for unused in ("bin", "lib", "share/man"):
            shutil.rmtree(prefix / unused, ignore_errors=True)
        shutil.move(prefix, tree / f"touchstone-{VERSION}.data" / "data")
        (tree / f"touchstone-{VERSION}.dist-info" / "WHEEL").write_text(
            f"Wheel-Version: 1.0\nGenerator: touchstone ({VERSION})\nRoot-Is-Purelib: false\nTag: {_TAG}\n")
        shutil.copy(ROOT / "LICENSE", tree / f"touchstone-{VERSION}.dist-info")
        _run(sys.executable, "-m", "wheel", "pack", tree, "--dest-dir", os.path.abspath(wheel_directory))
    return f"touchstone-{VERSION}-{_TAG}.whl"


def build_sdist(sdist_directory: str, config_settings: Optional[Mapping[str, str]] = None) -> str:
    _run("ci/release", "--sources", os.path.abspath(sdist_directory))
    return f"touchstone-{VERSION}.tar.gz"
