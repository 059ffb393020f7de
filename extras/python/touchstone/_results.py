"""Results of commands: every figure as the program's files have it, and how it looks in a notebook."""

import os
from pathlib import Path
from typing import Any, Dict, Iterator, List, Optional, Union

from . import _plots, _tables
from ._data import read_json
from ._models import model
from ._run import Result
from ._touchstone import BadData, Error, Model, Rendered, load_rendered


class JsonResult(Result):
    """A result whose figures are a JSON file of the program: `result["metrics"]` is as that file has it."""

    def __init__(self, status: int, text: str, data: Any, folder: Optional[Path] = None) -> None:
        super().__init__(status, text)
        self.data = data  #: the file, as dictionaries and lists; every digit
        self.folder = folder  #: with the report and everything else that the command wrote
        self.kept: Any = None  #: holds a temporary folder as long as this result lives

    def __getitem__(self, key: Any) -> Any:
        return self.data[key]

    def _file(self, name: str) -> Path:
        if self.folder is None:
            raise Error("this result has no folder")
        return self.folder / name

    def page(self) -> Path:
        """The report of this result: one HTML file that opens offline, with the 3-D view if there is one."""
        for name in ("report.html", "index.html"):
            if self.folder is not None and (self.folder / name).is_file():
                return self.folder / name
        raise Error("this result has no page")

    def show(self, height: int = 600) -> Any:
        """The report inside a notebook, `height` pixels high."""
        from IPython.display import IFrame

        return IFrame(os.path.relpath(self.page()), width="100%", height=height)


class Evaluation(JsonResult):
    """One renderer on one recording (result.json)."""

    @property
    def metrics(self) -> Dict[str, Optional[float]]:
        """Value by name, in the units of `units`; None if a metric has no value."""
        return {one["name"]: one["value"] for one in self.data["metrics"]}

    @property
    def units(self) -> Dict[str, str]:
        """Unit by the name of a metric."""
        return {one["name"]: one["unit"] for one in self.data["metrics"]}

    @property
    def title(self) -> str:
        """The renderer and the recording."""
        return str(self.data["title"])

    @property
    def rendered(self) -> Rendered:
        """What the renderer answered, one row per sample."""
        return load_rendered(self._file("rendered.csv"))

    def __repr__(self) -> str:
        rms = self.metrics.get("rms_force_error")
        return f"<Evaluation: {self.title}" + ("" if rms is None else f", RMS force error {rms:.4g} N") + ">"

    def _repr_html_(self) -> str:
        return _tables.evaluation(self.data)

    def plot(self, **options: Any) -> Any:
        """Measured and rendered force [N] over time, axis by axis. Returns matplotlib's figure."""
        return _plots.evaluation(self.data, **options)


def load_result(path: Union[str, "os.PathLike[str]"]) -> Evaluation:
    """Reads an evaluation's result.json, or the one in a folder."""
    path = Path(path)
    if path.is_dir():
        path = path / "result.json"
    data = read_json(path)
    if data.get("schema") != "touchstone-result/1":
        raise BadData(f"{path}: attribute 'schema' is {data.get('schema')!r}; 'touchstone-result/1' was expected")
    return Evaluation(0, f"{data['title']}\n", data, path.parent)


class Evaluations(JsonResult):
    """Several evaluations; `evaluations[0]` is the first, `evaluations["god-object"]` the first of that name."""

    def __init__(self, status: int, text: str, data: Any, folder: Optional[Path] = None) -> None:
        super().__init__(status, text, data, folder)
        results = [Path(one["folder"]) / "result.json" for one in data["evaluations"] if one.get("folder")]
        self._all: List[Evaluation] = [load_result(result) for result in results if result.is_file()]

    def __len__(self) -> int:
        return len(self._all)

    def __iter__(self) -> Iterator[Evaluation]:
        return iter(self._all)

    def __getitem__(self, key: Union[int, str]) -> Evaluation:
        if isinstance(key, int):
            return self._all[key]
        for one in self._all:
            if one.data["renderer"] == key or (one.folder is not None and one.folder.name == key):
                return one
        raise KeyError(f"{key}; there are {', '.join(one.data['renderer'] for one in self._all)}")

    def __repr__(self) -> str:
        return f"<Evaluations: {len(self)}>"

    def _repr_html_(self) -> str:
        return _tables.evaluations(self.data["evaluations"])

    def plot(self, metric: str = "rms_force_error", **options: Any) -> Any:
        """One metric of all, in its unit, one picture per input. Returns matplotlib's figure."""
        return _plots.metric(self.data["evaluations"], metric, **options)


class Comparison(JsonResult):
    """Two files, column by column."""

    @property
    def verdict(self) -> str:
        """"equal", or what is wrong."""
        return str(self.data["verdict"])


class Check(JsonResult):
    """Golden cases."""

    @property
    def tests(self) -> List[Dict[str, str]]:
        """For each case and model: case, model, state (passed, failed or skipped), and text, which says why."""
        return list(self.data)

    def _repr_html_(self) -> str:
        return _tables.table(["golden case", "model", "", ""],
                             [[one["case"], one["model"], one["state"], one["text"]] for one in self.data])


class Fit(JsonResult):
    """Parameters that were fitted (fit.json)."""

    @property
    def parameters(self) -> Dict[str, float]:
        """Fitted value by name; names carry their units."""
        return {one["name"]: one["value"] for one in self.data["parameters"]}

    @property
    def model(self) -> Model:
        """The model with the fitted values."""
        return model(self.data["model"])

    def _repr_html_(self) -> str:
        return _tables.fit(self.data)

    def plot(self, **options: Any) -> Any:
        """The metric over each parameter, with the fitted value. Returns matplotlib's figure."""
        return _plots.fit(self.data, **options)


class Findings(JsonResult):
    """What model and measurement disagree about (findings.json)."""

    @property
    def verdict(self) -> str:
        """What was concluded."""
        return str(self.data["verdict"])

    @property
    def model(self) -> Model:
        """The model with the effects that were found."""
        return Model.load(self._file("model.json"))

    def _repr_html_(self) -> str:
        return _tables.findings(self.data)

    def plot(self, **options: Any) -> Any:
        """The RMS force error [N] before and after, in parts of the motion. Returns matplotlib's figure."""
        return _plots.findings(self.data, **options)


class Perception(JsonResult):
    """What a person would notice (perception.json)."""

    def _repr_html_(self) -> str:
        return _tables.perception(self.data) or super()._repr_html_()

    def plot(self, **options: Any) -> Any:
        """The distance of each condition from the real process by channel, in just noticeable differences. Returns
        matplotlib's figure."""
        return _plots.perception(self.data, **options)


class Board(JsonResult):
    """A leaderboard (leaderboard.json)."""

    def _repr_html_(self) -> str:
        return _tables.board(self.data)

    def plot(self, **options: Any) -> Any:
        """RMS force errors [N] with their 95 % intervals, one picture per task. Returns matplotlib's figure."""
        return _plots.board(self.data, **options)


class Atlas(JsonResult):
    """Where renderers stick, pop through, lose contact or pull inward (atlas.json)."""

    def _repr_html_(self) -> str:
        return _tables.atlas(self.data)

    def plot(self, scene: str = "bump", mu: Optional[float] = None, **options: Any) -> Any:
        """A map per renderer, sharpness against stiffness [N/m], with the letters of the program's maps. Returns
        matplotlib's figure.

        Args:
            scene: "bump" or "shell".
            mu: the friction coefficient; the smallest if not given.
        """
        return _plots.atlas(self.data, scene, mu, **options)


class Scorecard(JsonResult):
    """What is wrong with renderers, by name: a dictionary per engine."""

    def _repr_html_(self) -> str:
        return _tables.scorecard(self.data)
