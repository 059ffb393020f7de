"""The commands of the program, run in this process through the program's own parser."""

import contextlib
import os
import tempfile
from pathlib import Path
from typing import Any, Dict, Iterator, List, Mapping, Tuple

from . import _touchstone, renderer
from ._models import model
from ._programs import PLUGIN
from ._tables import escape
from ._touchstone import BadData, Error, Mesh, Recording, Rendered, Trajectory, UsageError

#: Every command with its summary and options, as the program's parser knows them; "golden accept" and the like, too.
commands: Dict[str, Dict[str, Any]] = _touchstone.describe_commands()

#: Exit statuses of the program (harness/base/error.h) that are exceptions here.
_USAGE, _BAD_DATA, _SKIPPED = 2, 3, 77


class Skipped(Error):
    """Nothing could be judged here; the program ends with exit status 77."""


class Result:
    """What a command ended with."""

    def __init__(self, status: int, text: str) -> None:
        self.status = status  #: 0 passed, 1 a regression or disagreement
        self.text = text  #: what the program printed

    @property
    def passed(self) -> bool:
        """Whether the program found no regression and no disagreement beyond tolerance."""
        return self.status == 0

    def __bool__(self) -> bool:
        raise TypeError("ask for .passed: a result that is there is neither true nor false")

    def __repr__(self) -> str:
        return self.text.rstrip("\n")

    def _repr_html_(self) -> str:
        return f"<pre>{escape(self.text)}</pre>"


@contextlib.contextmanager
def _as_file(value: Any, suffix: str) -> Iterator[str]:
    """The path of a temporary file that holds an object in memory."""
    with tempfile.TemporaryDirectory(prefix="touchstone-") as folder:
        path = Path(folder) / f"{getattr(value, 'renderer', 'from-python')}{suffix}"
        if isinstance(value, (Mesh, Recording, Rendered, Trajectory)):
            value.save(path)
        else:
            path.write_text(model(value).to_json())
        yield str(path)


#: In which files objects in memory are written for a command (to the bit, all of them), and their types (_types.py).
FILE_KINDS = {
    **dict.fromkeys(("recording", "holdout", "real", "repeat", "EXPECTED", "OBTAINED"), (".h5", "RecordingLike")),
    "trajectory": (".h5", "TrajectoryLike"), "mesh": (".ply", "MeshLike"), "model": (".json", "ModelLike"),
}
#: Options of `perceive` whose values are named files: `condition={"omega": recording}` is `--condition omega=FILE`.
NAMED_FILES = {"condition": FILE_KINDS["recording"], "model": FILE_KINDS["model"]}


def _text(stack: contextlib.ExitStack, name: str, value: Any) -> str:
    """A value as the program's parser reads it."""
    is_path = isinstance(value, (str, os.PathLike))
    if name in FILE_KINDS and not is_path:
        file: str = stack.enter_context(_as_file(value, FILE_KINDS[name][0]))
        return file
    if is_path:
        return str(os.fspath(value))
    return repr(float(value)) if isinstance(value, float) else str(value)


def _named_files(stack: contextlib.ExitStack, name: str, value: Any) -> List[str]:
    if not isinstance(value, Mapping):
        return [_text(stack, "", one) for one in as_list(value)]
    words = []
    for label, one in value.items():
        is_path = isinstance(one, (str, os.PathLike))
        path = os.fspath(one) if is_path else stack.enter_context(_as_file(one, NAMED_FILES[name][0]))
        words.append(f"{label}={path}")
    return words


def _words(stack: contextlib.ExitStack, command: str, positional: Tuple[Any, ...], options: Mapping[str, Any]) -> List[str]:
    """The words of a command line. Which options there are is known to the program's parser alone."""
    known = commands[command]["options"]
    by_name = {one["name"].replace("-", "_"): one for one in known if not one["positional"]}
    places = [one for one in known if one["positional"]]
    words = []
    for name, value in options.items():
        if value is None:
            continue
        if name not in by_name:
            raise UsageError(f"{command}: there is no option {name}; there are {', '.join(sorted(by_name))}")
        option = by_name[name]
        if option["flag"]:
            words += [f"--{option['name']}"] if value else []
        elif command == "perceive" and name in NAMED_FILES:
            words += [f"--{option['name']}={text}" for text in _named_files(stack, name, value)]
        else:
            words += [f"--{option['name']}={_text(stack, name, one)}" for one in as_list(value)]
    given = [_text(stack, places[min(i, len(places) - 1)]["name"] if places else "", value)
             for i, value in enumerate(positional)]
    return [*command.split(), *words, *(["--", *given] if given else [])]


def as_list(value: Any) -> List[Any]:
    """What an option is given with: a list or tuple gives it several times, None not at all."""
    return [] if value is None else list(value) if isinstance(value, (list, tuple)) else [value]


def _add_python_renderers(options: Dict[str, Any], renderers: Any) -> None:
    for one in as_list(renderers):
        if isinstance(one, type):
            renderer.register(one)
        else:
            renderer.load_renderers(one)
            options.setdefault("plugin_source", str(Path(one).resolve().parent))
    options["plugin"] = [*as_list(options.get("plugin")), PLUGIN]
    options["plugin_in_process"] = True


def takes_plugins(command: str) -> bool:
    """Whether a command runs renderers from outside the program."""
    return any(one["name"] == "plugin" for one in commands[command]["options"])


def run(command: str, *positional: Any, **options: Any) -> Result:
    """Runs a command of the program in this process and returns its exit status and text.

    Args:
        command: its name; with its subcommand where it has one: "golden export".
        *positional: what the program takes without a name.
        **options: the program's, with underscores: `mesh_unit="mm"` is `--mesh-unit mm`. Flags take True; a list gives
            an option several times. Objects in memory (recordings, meshes, models) may stand where the program takes a
            file. `renderers` names classes of `Renderer`, or Python files with such classes, where the program takes
            `--plugin`.

    Raises UsageError (exit status 2) and BadData (3) with the program's messages, and Skipped (77). Exit status 1, a
    regression or disagreement, is no exception: see `Result.passed`.
    """
    if command not in commands:
        raise UsageError(f"there is no command {command}; there are {', '.join(sorted(commands))}")
    with contextlib.ExitStack() as stack:
        options = dict(options)
        if takes_plugins(command):
            renderers = options.pop("renderers", None)
            if renderers is not None:
                _add_python_renderers(options, renderers)
        status, text = _touchstone.run_command(_words(stack, command, positional, options))
    if status == _SKIPPED:
        raise Skipped(text.strip())
    if status == _BAD_DATA:
        raise BadData(text.strip())
    if status == _USAGE:
        raise UsageError(text.strip())
    return Result(status, text)
