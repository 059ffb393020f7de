"""What arguments may be, for type checkers."""

import os
from typing import Any, Mapping, Type, Union

from ._touchstone import Mesh, Model, Recording, Rendered, Trajectory
from .renderer import Renderer

PathLike = Union[str, "os.PathLike[str]"]
MeshLike = Union[Mesh, PathLike]
ModelLike = Union[Model, Type[Renderer], Mapping[str, Any], PathLike]
RecordingLike = Union[Recording, Rendered, PathLike]
TrajectoryLike = Union[Trajectory, Recording, Rendered, PathLike]
#: Of an option that takes a text: numbers and paths are written as the program reads them.
Text = Union[PathLike, float]
