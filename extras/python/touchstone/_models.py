"""Models, and replay in memory."""

import json
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any, Dict, List, Tuple, Union

from . import _touchstone, renderer
from ._programs import PLUGIN
from ._touchstone import Mesh, Model, Recording, Rendered, Trajectory, load_mesh, load_trajectory

if TYPE_CHECKING:
    from ._types import MeshLike, ModelLike, TrajectoryLike


def model(value: "ModelLike", **parameters: float) -> Model:
    """A model: a renderer with its parameters and effects.

    Args:
        value: a model file's path, the content of one as a dictionary, a class of `Renderer`, or a renderer's name.
        **parameters: with a name or class, the renderer's parameters: `model("god-object", stiffness_N_per_m=500)`.
    """
    if isinstance(value, Model) and not parameters:
        return value
    content: Any = value
    if isinstance(value, type):
        renderer.register(value)
        content = value.name
    if isinstance(content, (str, os.PathLike)) and not parameters and Path(content).suffix == ".json":
        return Model.load(content)
    if isinstance(content, str):
        content = {"schema": "touchstone-model/1", "renderer": content, "parameters": parameters}
    elif parameters:
        raise TypeError("parameters go with a renderer's name or class")
    return Model.parse(json.dumps(content), "model")


def _prepared(the_model: "ModelLike", mesh: "MeshLike", trajectory: "TrajectoryLike",
              mesh_unit: str) -> Tuple[Model, Mesh, Trajectory, List[str]]:
    if not isinstance(mesh, Mesh):
        mesh = load_mesh(mesh, unit=mesh_unit)
    if isinstance(trajectory, (Recording, Rendered)):
        trajectory = Trajectory(trajectory.time_s, trajectory.position_m,
                                orientation_xyzw=getattr(trajectory, "orientation_xyzw", None))
    elif not isinstance(trajectory, Trajectory):
        trajectory = load_trajectory(trajectory)
    the_model = model(the_model)
    plugins = [str(PLUGIN)] if any(one.name == the_model.renderer for one in renderer.registered()) else []
    return the_model, mesh, trajectory, plugins


def replay(model: "ModelLike", mesh: "MeshLike", trajectory: "TrajectoryLike", *, mesh_unit: str = "m",
           two_sided: bool = False, time_steps: bool = False) -> Rendered:
    """Runs one renderer over positions as they are, in memory: one step per sample, as a servo loop would call it.

    Args:
        model: what `touchstone.model` takes; a class of `touchstone.Renderer` runs with its defaults.
        mesh: a Mesh or a file, then in `mesh_unit`.
        trajectory: a Trajectory, a Recording (its positions), or a file.
        mesh_unit: m, mm, cm, km, um, in or ft.
        two_sided: triangles stop the tip from both sides.
        time_steps: measure each step; `step_us` of the result. Of a renderer in Python it is Python's cost.
    """
    the_model, mesh, trajectory, plugins = _prepared(model, mesh, trajectory, mesh_unit)
    return _touchstone.replay(the_model, mesh, trajectory, time_steps, two_sided, plugins)


def measure_steps(model: "ModelLike", mesh: "MeshLike", trajectory: "TrajectoryLike", *, mesh_unit: str = "m",
                  two_sided: bool = False) -> Dict[str, Union[int, float]]:
    """The cost of the renderer's steps alone [us]: mean_us, median_us, p99_us, p999_us, max_us; and steps, their number.

    Args: as for `replay`.
    """
    the_model, mesh, trajectory, plugins = _prepared(model, mesh, trajectory, mesh_unit)
    return _touchstone.measure_steps(the_model, mesh, trajectory, two_sided, plugins)
