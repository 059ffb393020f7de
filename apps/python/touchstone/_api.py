"""What `touchstone` offers besides renderers; see the package's own documentation."""

import atexit
import contextlib
import inspect
import json
import os
import sys
import tempfile
import xml.etree.ElementTree
from pathlib import Path
from typing import Any, Mapping, Union

from . import _plots, _touchstone, renderer
from ._touchstone import (
    BadData,
    Error,
    Mesh,
    Model,
    Recording,
    Rendered,
    RendererFailed,
    Surface,
    Trajectory,
    UsageError,
    __version__,
    build_info,
    load_mesh,
    load_recording,
    load_rendered,
    load_trajectory,
)

_HERE = Path(os.path.abspath(__file__)).parent
#: Renderers written in Python as a plug-in that every program of Touchstone loads.
PLUGIN = _HERE / "_python_renderer.so"

#: Every command with its summary and options, as the program's parser knows them.
commands = _touchstone.describe_commands()


class Skipped(Error):
    """What the program says with exit status 77: nothing could be judged here."""


def _find_program(name: str) -> Union[Path, None]:
    """A program of Touchstone: that of the tree or the prefix in which this package stands."""
    for folder in _HERE.parents:
        for place in (folder / "bin" / name, folder / "libexec" / "touchstone" / name):
            if place.is_file():
                return place
    return None


if "TOUCHSTONE_PLUGIN_HOST" not in os.environ and _find_program("touchstone-plugin-host"):
    os.environ["TOUCHSTONE_PLUGIN_HOST"] = str(_find_program("touchstone-plugin-host"))

# --- Progress ---


def _in_notebook() -> bool:
    shell = getattr(sys.modules.get("IPython"), "get_ipython", lambda: None)()
    return shell is not None and "IPKernelApp" in getattr(shell, "config", {})


class _Shown:
    """One line of a notebook that is drawn anew."""

    def __init__(self) -> None:
        self._handle = None

    def __call__(self, what: str, done: int, total: int) -> None:
        from IPython.display import HTML, display

        share = f' <progress value="{done}" max="{total}"></progress> {done}/{total}' if total else f" {done}"
        html = HTML(f"<small>{_plots.escape(what)}:{share}</small>")
        if self._handle is None:
            self._handle = display(html, display_id=True)
        else:
            self._handle.update(html)


def progress(call: Any = "auto") -> None:
    """Chooses how long work shows its progress: `call(what, done, total)` with total 0 where it is unknown, at most ten
    times a second; None for none; "auto" (the default) draws in a notebook, and on a terminal as the program does."""
    if call == "auto":
        call = _Shown() if _in_notebook() else None
    _touchstone.report_progress(call)


progress()
atexit.register(_touchstone.report_progress, None)

# --- Commands ---


@contextlib.contextmanager
def _as_file(value: Any, suffix: str):
    """The path of a file that holds the value: a path as it is, an object in memory written to a temporary file."""
    if isinstance(value, (str, os.PathLike)):
        yield os.fspath(value)
        return
    with tempfile.TemporaryDirectory(prefix="touchstone-") as folder:
        path = Path(folder) / f"{getattr(value, 'renderer', 'from-python')}{suffix}"
        if isinstance(value, (Mesh, Recording, Rendered, Trajectory)):
            value.save(path)
        else:
            path.write_text(model(value).to_json())
        yield str(path)


#: In which files objects in memory are written for a command: to the bit, all of them.
_FILE_KINDS = {
    "recording": ".h5", "holdout": ".h5", "real": ".h5", "repeat": ".h5", "EXPECTED": ".h5", "OBTAINED": ".h5",
    "trajectory": ".h5", "mesh": ".ply", "model": ".json", "tolerance": ".json", "instrument": ".json",
}


def _words(stack: contextlib.ExitStack, command: str, positional: tuple, options: Mapping[str, Any]) -> list:
    """The words of a command line. Which options there are is known to the program's parser alone."""
    known = commands[command]["options"]
    by_name = {one["name"].replace("-", "_"): one for one in known if not one["positional"]}
    places = [one for one in known if one["positional"]]
    words = []

    def text(name: str, value: Any) -> str:
        if isinstance(value, Mapping) and name in ("condition", "model") and command == "perceive":
            raise TypeError(f"{name}: write NAME=FILE")
        if name in _FILE_KINDS and not isinstance(value, (str, os.PathLike)):
            return stack.enter_context(_as_file(value, _FILE_KINDS[name]))
        return repr(value) if isinstance(value, float) else os.fspath(value) if isinstance(value, os.PathLike) else str(value)

    for name, value in options.items():
        if value is None:
            continue
        if name not in by_name:
            raise UsageError(f"{command}: there is no option {name}; there are {', '.join(sorted(by_name))}")
        option = by_name[name]
        if option["flag"]:
            if value:
                words.append(f"--{option['name']}")
            continue
        several = isinstance(value, (list, tuple))
        for one in value if several else [value]:
            words.append(f"--{option['name']}={text(name, one)}")
    given = [text(places[min(i, len(places) - 1)]["name"], value) if places else str(value)
             for i, value in enumerate(positional)]
    return [command, *words, *(["--", *given] if given else [])]


def run(command: str, *positional: Any, **options: Any) -> "Result":
    """Runs a command of the program in this process and returns its exit status and text.

    Options are the program's with underscores: `mesh_unit="mm"` is `--mesh-unit mm`; flags take True; a list gives an
    option several times. Objects in memory (recordings, meshes, models) may stand where the program takes a file.
    Raises UsageError (exit status 2) and BadData (3) with the program's messages, and Skipped (77). Exit status 1, a
    regression or disagreement, is no exception: see `Result.passed`.
    """
    if command not in commands:
        raise UsageError(f"there is no command {command}; there are {', '.join(sorted(commands))}")
    with contextlib.ExitStack() as stack:
        options = dict(options)
        renderers = options.pop("renderers", None)
        if renderers is not None:
            _add_python_renderers(options, renderers)
        status, text = _touchstone.run_command(_words(stack, command, positional, options))
    if status == 77:
        raise Skipped(text.strip())
    if status == 3:
        raise BadData(text.strip())
    return Result(status, text)


def _add_python_renderers(options: dict, renderers: Any) -> None:
    for one in renderers if isinstance(renderers, (list, tuple)) else [renderers]:
        if isinstance(one, type):
            renderer.register(one)
        else:
            renderer.load_renderers(one)
            options.setdefault("plugin_source", str(Path(one).resolve().parent))
    options["plugin"] = [*_listed(options.get("plugin")), PLUGIN]
    options["plugin_in_process"] = True


def _listed(value: Any) -> list:
    return [] if value is None else list(value) if isinstance(value, (list, tuple)) else [value]


class Result:
    """What a command ended with."""

    def __init__(self, status: int, text: str) -> None:
        self.status = status  #: 0 passed, 1 a regression or disagreement
        self.text = text  #: what the program printed

    @property
    def passed(self) -> bool:
        return self.status == 0

    def __bool__(self) -> bool:
        raise TypeError("ask for .passed: a result that is there is neither true nor false")

    def __repr__(self) -> str:
        return self.text.rstrip("\n")

    def _repr_html_(self) -> str:
        return f"<pre>{_plots.escape(self.text)}</pre>"


class _Json(Result):
    """A result whose figures are a JSON file of the program: `result["metrics"]` is as that file has it."""

    def __init__(self, status: int, text: str, data: Any, folder: Union[Path, None] = None) -> None:
        super().__init__(status, text)
        self.data = data  #: the file, as dictionaries and lists; every digit
        self.folder = folder  #: with the report and everything else that the command wrote

    def __getitem__(self, key: Any) -> Any:
        return self.data[key]

    def page(self) -> Path:
        """The report of this result: one HTML file that opens offline, with the 3-D view where there is one."""
        for name in ("report.html", "index.html"):
            if self.folder is not None and (self.folder / name).is_file():
                return self.folder / name
        raise Error("this result has no page")

    def show(self, height: int = 600) -> Any:
        """The report inside a notebook."""
        from IPython.display import IFrame

        return IFrame(os.path.relpath(self.page()), width="100%", height=height)


def _read_json(path: Union[str, os.PathLike]) -> Any:
    return json.loads(Path(path).read_text(encoding="utf-8"))


class Evaluation(_Json):
    """One renderer on one recording (result.json)."""

    @property
    def metrics(self) -> dict:
        """Value by name, in the units of `units`; None where a metric has no value."""
        return {one["name"]: one["value"] for one in self.data["metrics"]}

    @property
    def units(self) -> dict:
        """Unit by the name of a metric."""
        return {one["name"]: one["unit"] for one in self.data["metrics"]}

    @property
    def title(self) -> str:
        return self.data["title"]

    @property
    def rendered(self) -> Rendered:
        """What the renderer answered."""
        assert self.folder is not None
        return load_rendered(self.folder / "rendered.csv")

    def __repr__(self) -> str:
        rms = self.metrics.get("rms_force_error")
        return f"<Evaluation: {self.title}" + ("" if rms is None else f", RMS force error {rms:.4g} N") + ">"

    def _repr_html_(self) -> str:
        return _plots.evaluation_html(self.data)

    def plot(self, **options: Any) -> Any:
        """Measured and rendered force over time, and their difference. Returns matplotlib's figure."""
        return _plots.plot_evaluation(self.data, **options)


class Evaluations(_Json):
    """Several evaluations; `evaluations[0]` is the first, `evaluations["god-object"]` the first of that name."""

    def __init__(self, status: int, text: str, data: Any, folder: Path) -> None:
        super().__init__(status, text, data, folder)
        self._all = [
            load_result(Path(one["folder"]) / "result.json")
            for one in data["evaluations"]
            if (Path(one["folder"]) / "result.json").is_file()
        ]

    def __len__(self) -> int:
        return len(self._all)

    def __iter__(self) -> Any:
        return iter(self._all)

    def __getitem__(self, key: Any) -> Evaluation:
        if isinstance(key, str):
            for one in self._all:
                if one.data["renderer"] == key or (one.folder is not None and one.folder.name == key):
                    return one
            raise KeyError(f"{key}; there are {', '.join(one.data['renderer'] for one in self._all)}")
        return self._all[key]

    def _repr_html_(self) -> str:
        return _plots.evaluations_html([one.data for one in self._all])

    def plot(self, metric: str = "rms_force_error", **options: Any) -> Any:
        """One metric of all. Returns matplotlib's figure."""
        return _plots.plot_metric([one.data for one in self._all], metric, **options)


class Comparison(_Json):
    """Two files, column by column."""

    @property
    def verdict(self) -> str:
        return self.data["verdict"]


class Check(_Json):
    """Golden cases: `tests` has a dictionary with name, model, verdict, passed and text for each."""

    @property
    def tests(self) -> list:
        return self.data

    def _repr_html_(self) -> str:
        rows = [[one["name"], "passed" if one["passed"] else "FAILED", one["text"]] for one in self.data]
        return _plots.table_html(["golden case", "", ""], rows)


class Fit(_Json):
    """Parameters that were fitted (fit.json)."""

    @property
    def parameters(self) -> dict:
        """Fitted value by name; names carry their units."""
        return {one["name"]: one["value"] for one in self.data["parameters"]}

    @property
    def model(self) -> Model:
        """The model with the fitted values."""
        return model(self.data["model"])

    def _repr_html_(self) -> str:
        return _plots.fit_html(self.data)

    def plot(self, **options: Any) -> Any:
        return _plots.plot_fit(self.data, **options)


class Findings(_Json):
    """What model and measurement disagree about (findings.json)."""

    @property
    def model(self) -> Model:
        """The model with the effects that were found."""
        assert self.folder is not None
        return Model.load(self.folder / "model.json")

    def _repr_html_(self) -> str:
        return _plots.findings_html(self.data)

    def plot(self, **options: Any) -> Any:
        """The gap before and after, in parts of the motion. Returns matplotlib's figure."""
        return _plots.plot_findings(self.data, **options)


class Perception(_Json):
    """What a person would notice (perception.json)."""


class Board(_Json):
    """A leaderboard (leaderboard.json)."""

    def _repr_html_(self) -> str:
        return _plots.board_html(self.data)

    def plot(self, **options: Any) -> Any:
        """Scores with their intervals, one picture per task. Returns matplotlib's figure."""
        return _plots.plot_board(self.data, **options)


class Atlas(_Json):
    """Where renderers stick, pop through, lose contact or pull inward (atlas.json)."""

    def _repr_html_(self) -> str:
        return _plots.atlas_html(self.data)

    def plot(self, **options: Any) -> Any:
        """A map per renderer: sharpness against stiffness. Returns matplotlib's figure."""
        return _plots.plot_atlas(self.data, **options)


class Scorecard(_Json):
    """What is wrong with renderers, by name: a dictionary per engine."""

    def _repr_html_(self) -> str:
        return _plots.scorecard_html(self.data)


def load_result(path: Union[str, os.PathLike]) -> Evaluation:
    """Reads an evaluation's result.json, or the one in a folder."""
    path = Path(path)
    if path.is_dir():
        path = path / "result.json"
    data = _read_json(path)
    if data.get("schema") != "touchstone-result/1":
        raise BadData(f"{path}: attribute 'schema' is {data.get('schema')!r}; 'touchstone-result/1' was expected")
    return Evaluation(0, f"{data['title']}\n", data, path.parent)


def _default(command: str, option: str) -> str:
    return next(one["default"] for one in commands[command]["options"] if one["name"] == option)


def _command(name: str, kind: type, file: Union[str, None] = None):
    """A function for a command that writes `file` into the folder of --out."""

    def call(*positional: Any, **options: Any) -> Any:
        folder = Path(options.get("out") or _default(name, "out"))
        result = run(name, *positional, **options)
        return kind(result.status, result.text, _read_json(folder / file), folder)

    return _documented(call, name, kind)


def _documented(call: Any, name: str, kind: type) -> Any:
    about = commands[name]
    lines = [about["summary"] + ".", "", f"Returns {kind.__name__}. Options, as of `touchstone {name}`:", ""]
    parameters = []
    for one in about["options"]:
        default = f" (default {one['default']})" if one["default"] else ""
        python = one["name"] if one["positional"] else one["name"].replace("-", "_")
        lines.append(f"    {python}: {one['meaning']}{default}")
        if one["positional"]:
            kind_of = inspect.Parameter.VAR_POSITIONAL if one["several"] else inspect.Parameter.POSITIONAL_ONLY
            parameters.append(inspect.Parameter(python, kind_of))
        elif one["name"] not in ("plugin-in-process",):
            parameters.append(inspect.Parameter(python, inspect.Parameter.KEYWORD_ONLY, default=None))
    if any(one["name"] == "plugin" for one in about["options"]):
        lines.append("    renderers: classes of touchstone.Renderer, or Python files with such classes")
        parameters.append(inspect.Parameter("renderers", inspect.Parameter.KEYWORD_ONLY, default=None))
    order = {inspect.Parameter.POSITIONAL_ONLY: 0, inspect.Parameter.VAR_POSITIONAL: 1}
    parameters.sort(key=lambda one: order.get(one.kind, 2))
    call.__name__ = call.__qualname__ = name
    call.__doc__ = "\n".join(lines)
    call.__signature__ = inspect.Signature(parameters)
    call.__module__ = "touchstone"
    return call


def _evaluate(*positional: Any, **options: Any) -> Union[Evaluation, Evaluations]:
    folder = Path(options.get("out") or _default("evaluate", "out"))
    with tempfile.TemporaryDirectory(prefix="touchstone-") as temporary:
        summary = options.pop("json", None) or Path(temporary) / "evaluations.json"
        result = run("evaluate", *positional, json=summary, **options)
        data = _read_json(summary)
    if len(data["evaluations"]) > 1:
        return Evaluations(result.status, result.text, data, folder)
    one = load_result(data["evaluations"][0]["folder"])
    return Evaluation(result.status, result.text, one.data, one.folder)


def _compare(*positional: Any, **options: Any) -> Comparison:
    with tempfile.TemporaryDirectory(prefix="touchstone-") as temporary:
        path = options.pop("json", None) or Path(temporary) / "comparison.json"
        result = run("compare", *positional, json=path, **options)
        return Comparison(result.status, result.text, _read_json(path))


def _check(*positional: Any, **options: Any) -> Check:
    with tempfile.TemporaryDirectory(prefix="touchstone-") as temporary:
        path = options.pop("junit", None) or Path(temporary) / "golden.xml"
        result = run("check", *positional, junit=path, **options)
        tests = []
        for one in xml.etree.ElementTree.parse(path).getroot().iter("testcase"):
            failures = list(one.iter("failure"))
            name = f"{one.get('classname', '')} {one.get('name', '')}".strip()
            text = "" if not failures else (failures[0].get("message") or failures[0].text or "").strip()
            tests.append({"name": name, "passed": not failures, "text": text})
        return Check(result.status, result.text, tests)


def _scorecard(*positional: Any, **options: Any) -> Scorecard:
    folder = Path(options.get("out") or _default("scorecard", "out"))
    before = {path: path.stat().st_mtime_ns for path in folder.glob("*.json")} if folder.is_dir() else {}
    result = run("scorecard", *positional, **options)
    written = [path for path in sorted(folder.glob("*.json")) if path.stat().st_mtime_ns != before.get(path)]
    return Scorecard(result.status, result.text, [_read_json(path) for path in written], folder)


evaluate = _documented(_evaluate, "evaluate", Evaluation)
compare = _documented(_compare, "compare", Comparison)
check = _documented(_check, "check", Check)
scorecard = _documented(_scorecard, "scorecard", Scorecard)
fit = _command("fit", Fit, "fit.json")
discrepancy = _command("discrepancy", Findings, "findings.json")
perceive = _command("perceive", Perception, "perception.json")
leaderboard = _command("leaderboard", Board, "leaderboard.json")
atlas = _command("atlas", Atlas, "atlas.json")

# --- Models and replay in memory ---


def model(value: Any, **parameters: float) -> Model:
    """A model from a model file's path, from the content of one as a dictionary, from a class of `Renderer`, or from a
    renderer's name with its parameters: `model("god-object", stiffness_N_per_m=500)`."""
    if isinstance(value, Model) and not parameters:
        return value
    if isinstance(value, type):
        renderer.register(value)
        value = value.name
    if isinstance(value, (str, os.PathLike)) and not parameters and Path(value).suffix == ".json":
        return Model.load(value)
    if isinstance(value, str):
        value = {"schema": "touchstone-model/1", "renderer": value, "parameters": parameters}
    elif parameters:
        raise TypeError("parameters go with a renderer's name or class")
    return Model.parse(json.dumps(value), "model")


def _prepared(the_model: Any, mesh: Any, trajectory: Any, mesh_unit: str) -> tuple:
    if not isinstance(mesh, Mesh):
        mesh = load_mesh(mesh, unit=mesh_unit)
    if isinstance(trajectory, (Recording, Rendered)):
        trajectory = Trajectory(trajectory.time_s, trajectory.position_m,
                                orientation_xyzw=getattr(trajectory, "orientation_xyzw", None))
    elif not isinstance(trajectory, Trajectory):
        trajectory = load_trajectory(trajectory)
    the_model = model(the_model)
    own = [str(PLUGIN)] if any(one.name == the_model.renderer for one in renderer._registered) else []
    return the_model, mesh, trajectory, own


def replay(model: Any, mesh: Any, trajectory: Any, *, mesh_unit: str = "m", two_sided: bool = False,
           time_steps: bool = False) -> Rendered:
    """Runs one renderer over positions as they are, in memory: one step per sample, as a servo loop would call it.

    Args:
        model: what `touchstone.model` takes; a class of `touchstone.Renderer` runs with its defaults.
        mesh: a Mesh or a file, then in `mesh_unit`.
        trajectory: a Trajectory, a Recording (its positions), or a file.
        two_sided: triangles stop the tip from both sides.
        time_steps: measure each step; `step_us` of the result. Of a renderer in Python it is Python's cost.
    """
    the_model, mesh, trajectory, own = _prepared(model, mesh, trajectory, mesh_unit)
    return _touchstone.replay(the_model, mesh, trajectory, time_steps, two_sided, own)


def measure_steps(model: Any, mesh: Any, trajectory: Any, *, mesh_unit: str = "m", two_sided: bool = False) -> dict:
    """The cost of the renderer's steps alone [us]: mean_us, median_us, p99_us, p999_us, max_us, and their number."""
    the_model, mesh, trajectory, own = _prepared(model, mesh, trajectory, mesh_unit)
    return _touchstone.measure_steps(the_model, mesh, trajectory, two_sided, own)


# --- Data that comes with the program, and data whose answer is known ---


def bundled(name: str) -> Path:
    """A folder that comes with the program: "datasets" or "golden"."""
    for folder in _HERE.parents:
        if (folder / "share" / "touchstone" / name).is_dir():
            return folder / "share" / "touchstone" / name
    raise BadData(f"the folder share/touchstone/{name} is in no folder above {_HERE}; is the package touchstone installed?")


class DataSet:
    """An object with recordings of it: a folder with dataset.json."""

    def __init__(self, folder: Union[str, os.PathLike]) -> None:
        self.folder = Path(folder)
        self.data = _read_json(self.folder / "dataset.json")

    @property
    def mesh(self) -> Mesh:
        return load_mesh(self.folder / self.data["mesh"]["file"], unit=self.data["mesh"].get("unit", "m"))

    @property
    def recordings(self) -> list:
        return [load_recording(self.folder / one["file"]) for one in self.data["recordings"]]

    def __repr__(self) -> str:
        return f"<DataSet {self.folder.name}: {self.data['object']}>"


def datasets() -> dict:
    """The data sets that come with the program, by name."""
    return {place.parent.name: DataSet(place.parent) for place in sorted(bundled("datasets").glob("*/dataset.json"))}


class synthetic:
    """Surfaces in closed form with their exact answers, and trajectories, by the names of `touchstone synth`."""

    @staticmethod
    def surfaces() -> list:
        """Every surface with its parameters."""
        return _touchstone._synthetic.surfaces()

    @staticmethod
    def trajectories() -> list:
        """Every trajectory with its parameters."""
        return _touchstone._synthetic.trajectories()

    @staticmethod
    def surface(name: str, **parameters: float) -> Surface:
        """The surface itself: closest points, signed distances and exact contacts in closed form."""
        return _touchstone._synthetic.surface(name, parameters)

    @staticmethod
    def mesh(name: str, triangles: int = 10000, **parameters: float) -> Mesh:
        """A mesh of the surface with about so many triangles."""
        return _touchstone._synthetic.mesh(name, parameters, triangles)[0]

    @staticmethod
    def mesh_deviation_m(name: str, triangles: int = 10000, **parameters: float) -> float:
        """How far that mesh is from the surface at most [m]."""
        return _touchstone._synthetic.mesh(name, parameters, triangles)[1]

    @staticmethod
    def trajectory(name: str, rate_Hz: float = 1000.0, seed: int = 1, **parameters: float) -> Trajectory:
        """Positions over time."""
        return Trajectory(*_touchstone._synthetic.path(name, parameters, rate_Hz, seed))


# --- What a notebook shows of data ---


def _describe(self: Any) -> str:
    return f"<{type(self).__name__}: {len(self)} samples>"


Recording.__repr__ = Trajectory.__repr__ = Rendered.__repr__ = _describe
Mesh.__repr__ = lambda self: f"<Mesh: {len(self)} triangles, {len(self.vertices_m)} vertices>"
Recording._repr_html_ = _plots.recording_html
Recording.plot = _plots.plot_recording
Rendered._repr_html_ = _plots.recording_html
Rendered.plot = _plots.plot_recording
