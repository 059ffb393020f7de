"""Where the parts of an installation are that are no Python."""

import os
from pathlib import Path
from typing import Optional

from ._touchstone import BadData

_HERE = Path(os.path.abspath(__file__)).parent

#: Renderers written in Python as a plug-in that every program of Touchstone loads.
PLUGIN = _HERE / "_python_renderer.so"


def find_program(name: str) -> Optional[Path]:
    """A program of Touchstone: that of the tree or the prefix in which this package stands."""
    for folder in _HERE.parents:
        for place in (folder / "bin" / name, folder / "libexec" / "touchstone" / name):
            if place.is_file():
                return place
    return None


def bundled(name: str) -> Path:
    """A folder that comes with the program: "datasets" or "golden"."""
    for folder in _HERE.parents:
        if (folder / "share" / "touchstone" / name).is_dir():
            return folder / "share" / "touchstone" / name
    raise BadData(f"the folder share/touchstone/{name} is in no folder above {_HERE}; is the package touchstone installed?")


def _name_plugin_host() -> None:
    """Plug-ins run in a program that is not beside Python's: the library is told where it is."""
    host = find_program("touchstone-plugin-host")
    if host is not None:
        os.environ.setdefault("TOUCHSTONE_PLUGIN_HOST", str(host))


_name_plugin_host()
