"""Data that come with the program: data sets and golden cases."""

import json
import os
import tempfile
from pathlib import Path
from typing import Any, Dict, List, Union

from ._programs import bundled
from ._run import run
from ._touchstone import (
    Mesh,
    Model,
    Recording,
    Rendered,
    Trajectory,
    UsageError,
    load_mesh,
    load_recording,
    load_rendered,
    load_trajectory,
)

_Place = Union[str, "os.PathLike[str]"]


def read_json(path: _Place) -> Any:
    return json.loads(Path(path).read_text(encoding="utf-8"))


class DataSet:
    """An object with recordings of it: a folder with dataset.json."""

    def __init__(self, folder: _Place) -> None:
        self.folder = Path(folder)
        self.data: Dict[str, Any] = read_json(self.folder / "dataset.json")  #: the file, every digit

    @property
    def mesh(self) -> Mesh:
        """The object, in metres."""
        return load_mesh(self.folder / self.data["mesh"]["file"], unit=self.data["mesh"].get("unit", "m"))

    @property
    def recordings(self) -> List[Recording]:
        """All of them, in the order of the file."""
        return [load_recording(self.folder / one["file"]) for one in self.data["recordings"]]

    def __repr__(self) -> str:
        return f"<DataSet {self.folder.name}: {self.data['object']}>"


def datasets() -> Dict[str, DataSet]:
    """The data sets that come with the program, by name."""
    return {place.parent.name: DataSet(place.parent) for place in sorted(bundled("datasets").glob("*/dataset.json"))}


class Golden:
    """A golden case: what models must give along a trajectory over a synthetic surface. A folder with case.json."""

    def __init__(self, folder: _Place) -> None:
        self.folder = Path(folder)
        self.data: Dict[str, Any] = read_json(self.folder / "case.json")  #: the file, every digit

    @property
    def models(self) -> Dict[str, Model]:
        """By the name under which the case knows them."""
        return {name: Model.parse(json.dumps(one), name) for name, one in self.data["models"].items()}

    def expected(self, model: str) -> Rendered:
        """What the model must give, within the case's tolerance."""
        if model not in self.data["models"]:
            raise UsageError(f"{self.folder}: there is no model {model}; there are {', '.join(self.data['models'])}")
        return load_rendered(self.folder / "expected" / f"{model}.h5")

    def _exported(self, file: str, load: Any) -> Any:
        with tempfile.TemporaryDirectory(prefix="touchstone-") as folder:
            run("golden export", self.folder.name, golden=self.folder.parent, to=folder)
            return load(next(Path(folder).rglob(file)))

    @property
    def mesh(self) -> Mesh:
        """The case's surface as the renderers get it, in metres."""
        mesh: Mesh = self._exported("mesh.*", load_mesh)
        return mesh

    @property
    def trajectory(self) -> Trajectory:
        """The way of the tip."""
        trajectory: Trajectory = self._exported("trajectory.*", load_trajectory)
        return trajectory

    def __repr__(self) -> str:
        return f"<Golden {self.folder.name}: {self.data['summary']}>"


def goldens() -> Dict[str, Golden]:
    """The golden cases that come with the program, by name. To accept new results: `run("golden accept", ...)`."""
    return {place.parent.name: Golden(place.parent) for place in sorted(bundled("golden").glob("*/case.json"))}
