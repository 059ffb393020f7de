"""Writes _commands.pyi of the package: the types of the functions for commands, from the program's own parser.

    write_stubs.py PACKAGE      PACKAGE: the folder that holds touchstone/
"""

import inspect
import sys
from pathlib import Path

package = Path(sys.argv[1])
sys.path.insert(0, str(package))

from touchstone import _commands  # noqa: E402
from touchstone._run import FILE_KINDS, NAMED_FILES, commands, takes_plugins  # noqa: E402

#: What the functions return, in their order in _commands.py.
RETURNS = {"atlas": "Atlas", "check": "Check", "compare": "Comparison", "discrepancy": "Findings",
           "evaluate": "Union[Evaluation, Evaluations]", "fit": "Fit", "leaderboard": "Board", "perceive": "Perception",
           "scorecard": "Scorecard"}

HEAD = '''"""Types of the functions for commands, written by extras/python/write_stubs.py from the program's own parser."""

import inspect
from typing import Any, List, Mapping, Optional, Sequence, Type, Union

from ._results import (
    Atlas,
    Board,
    Check,
    Comparison,
    Evaluation,
    Evaluations,
    Findings,
    Fit,
    Perception,
    Scorecard,
)
from ._types import MeshLike, ModelLike, PathLike, RecordingLike, Text, TrajectoryLike
from .renderer import Renderer

def parameters_of(name: str) -> List[inspect.Parameter]: ...
'''


def type_of(option: dict, command: str) -> str:
    if option["flag"]:
        return "bool"
    if command == "perceive" and option["name"] in NAMED_FILES:
        return f"Union[str, Sequence[str], Mapping[str, {NAMED_FILES[option['name']][1]}]]"
    if command in ("check", "scorecard") and option["name"] == "model":
        kind = "str"
    elif option["name"] in FILE_KINDS:
        kind = FILE_KINDS[option["name"]][1]
    elif option["type"].startswith("UINT") or option["type"].startswith("INT"):
        kind = "int"
    elif option["type"].startswith("FLOAT"):
        kind = "float"
    else:
        kind = "Text"
    return f"Union[{kind}, Sequence[{kind}]]" if option["several"] else kind


def function(name: str) -> str:
    options = {one["name"].replace("-", "_"): one for one in commands[name]["options"]}
    words, seen_keyword = [], False
    for parameter in _commands.parameters_of(name):
        option = options.get(parameter.name)
        kind = ("Union[Type[Renderer], PathLike, Sequence[Union[Type[Renderer], PathLike]]]"
                if parameter.name == "renderers" and takes_plugins(name) else type_of(option, name))
        if parameter.kind is inspect.Parameter.VAR_POSITIONAL:
            words.append(f"*{parameter.name}: PathLike")
            seen_keyword = True
        elif parameter.kind is inspect.Parameter.POSITIONAL_ONLY:
            words.append(f"{parameter.name}: {kind}")
        else:
            if not seen_keyword:
                if words:
                    words.append("/")
                words.append("*")
                seen_keyword = True
            words.append(f"{parameter.name}: Optional[{kind}] = None")
    about = commands[name]["summary"]
    lines = "".join(f"    {word},\n" for word in words)
    return f'\ndef {name}(\n{lines}) -> {RETURNS[name]}:\n    """{about}."""\n'


text = HEAD + "".join(function(name) for name in RETURNS)
place = package / "touchstone" / "_commands.pyi"
if not place.is_file() or place.read_text() != text:
    place.write_text(text)
