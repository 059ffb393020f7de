"""A function for each command that people call from a notebook, with the program's own options.

Their parameters come from the program's parser; `_commands.pyi`, which type checkers read, is written from the same
(extras/python/write_stubs.py)."""

import inspect
import os
import tempfile
from pathlib import Path
from typing import Any, Callable, Dict, List, Optional, Type, Union

from ._data import read_json
from ._golden_results import read_junit
from ._results import (
    Atlas,
    Board,
    Check,
    Comparison,
    Evaluation,
    Evaluations,
    Findings,
    Fit,
    JsonResult,
    Perception,
    Scorecard,
    load_result,
)
from ._run import commands, run, takes_plugins


def parameters_of(name: str) -> List[inspect.Parameter]:
    """Of the Python function of a command: what the program takes, and `renderers`."""
    parameters = []
    for one in commands[name]["options"]:
        python = one["name"].replace("-", "_")
        if one["positional"]:
            kind = inspect.Parameter.VAR_POSITIONAL if one["several"] else inspect.Parameter.POSITIONAL_ONLY
            parameters.append(inspect.Parameter(python, kind))
        elif one["name"] != "plugin-in-process":
            parameters.append(inspect.Parameter(python, inspect.Parameter.KEYWORD_ONLY, default=None))
    if takes_plugins(name):
        parameters.append(inspect.Parameter("renderers", inspect.Parameter.KEYWORD_ONLY, default=None))
    order = {inspect.Parameter.POSITIONAL_ONLY: 0, inspect.Parameter.VAR_POSITIONAL: 1}
    return sorted(parameters, key=lambda one: order.get(one.kind, 2))


def _documented(call: Callable[..., Any], name: str, returns: str) -> Callable[..., Any]:
    about = commands[name]
    lines = [about["summary"] + ".", "", f"Returns {returns}. Options, as of `touchstone {name}`:", ""]
    for one in about["options"]:
        default = f" (default {one['default']})" if one["default"] else ""
        python = one["name"] if one["positional"] else one["name"].replace("-", "_")
        lines.append(f"    {python}: {one['meaning']}{default}")
    if takes_plugins(name):
        lines.append("    renderers: classes of touchstone.Renderer, or Python files with such classes")
    call.__name__ = call.__qualname__ = name
    call.__doc__ = "\n".join(lines)
    call.__signature__ = inspect.Signature(parameters_of(name))  # type: ignore[attr-defined]
    call.__module__ = "touchstone"
    return call


def _default_out(command: str) -> str:
    return next((str(one["default"]) for one in commands[command]["options"] if one["name"] == "out"), "")


def _with_folder(name: str, kind: Type[JsonResult], file: str) -> Callable[..., Any]:
    """A function for a command that writes `file` into the folder of --out."""

    def call(*positional: Any, **options: Any) -> JsonResult:
        out: Union[str, "os.PathLike[str]", None] = options.get("out") or _default_out(name)
        kept: Optional["tempfile.TemporaryDirectory[str]"] = None
        required = any(one["name"] == "out" and one["required"] for one in commands[name]["options"])
        if not out and not required:
            # The program keeps nothing then; the result keeps its folder as long as it lives.
            kept = tempfile.TemporaryDirectory(prefix="touchstone-")
            options["out"] = out = kept.name
        result = run(name, *positional, **options)
        folder = Path(out or "")
        done = kind(result.status, result.text, read_json(folder / file), folder)
        done.kept = kept
        return done

    return _documented(call, name, kind.__name__)


def _evaluate(*positional: Any, **options: Any) -> Union[Evaluation, Evaluations]:
    folder = Path(options.get("out") or _default_out("evaluate"))
    with tempfile.TemporaryDirectory(prefix="touchstone-") as temporary:
        summary = options.pop("json", None) or Path(temporary) / "evaluations.json"
        result = run("evaluate", *positional, json=summary, **options)
        data = read_json(summary)
    if len(data["evaluations"]) > 1:
        return Evaluations(result.status, result.text, data, folder)
    one = load_result(data["evaluations"][0]["folder"])
    return Evaluation(result.status, result.text, one.data, one.folder)


def _compare(*positional: Any, **options: Any) -> Comparison:
    with tempfile.TemporaryDirectory(prefix="touchstone-") as temporary:
        path = options.pop("json", None) or Path(temporary) / "comparison.json"
        result = run("compare", *positional, json=path, **options)
        return Comparison(result.status, result.text, read_json(path))


def _check(*positional: Any, **options: Any) -> Check:
    with tempfile.TemporaryDirectory(prefix="touchstone-") as temporary:
        path = options.pop("junit", None) or Path(temporary) / "golden.xml"
        result = run("check", *positional, junit=path, **options)
        return Check(result.status, result.text, read_junit(path))


def _scorecard(*positional: Any, **options: Any) -> Scorecard:
    folder = Path(options.get("out") or _default_out("scorecard"))
    before: Dict[Path, int] = {path: path.stat().st_mtime_ns for path in folder.glob("*.json")} if folder.is_dir() else {}
    result = run("scorecard", *positional, **options)
    written = [path for path in sorted(folder.glob("*.json")) if path.stat().st_mtime_ns != before.get(path)]
    return Scorecard(result.status, result.text, [read_json(path) for path in written], folder)


evaluate = _documented(_evaluate, "evaluate", "Evaluation, or Evaluations if there are several")
compare = _documented(_compare, "compare", "Comparison")
check = _documented(_check, "check", "Check")
scorecard = _documented(_scorecard, "scorecard", "Scorecard")
fit = _with_folder("fit", Fit, "fit.json")
discrepancy = _with_folder("discrepancy", Findings, "findings.json")
perceive = _with_folder("perceive", Perception, "perception.json")
leaderboard = _with_folder("leaderboard", Board, "leaderboard.json")
atlas = _with_folder("atlas", Atlas, "atlas.json")
