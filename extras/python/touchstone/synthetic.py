"""Surfaces in closed form with their exact answers, and trajectories, by the names of `touchstone synth`."""

from typing import Any, Dict, List

from . import _touchstone
from ._touchstone import Mesh, Surface, Trajectory

__all__ = ["mesh", "mesh_deviation_m", "surface", "surfaces", "trajectories", "trajectory"]


def surfaces() -> List[Dict[str, Any]]:
    """Every surface: name, summary, and parameters with unit, range, default and meaning."""
    return _touchstone._synthetic.surfaces()


def trajectories() -> List[Dict[str, Any]]:
    """Every trajectory: name, summary, and parameters with unit, range, default and meaning."""
    return _touchstone._synthetic.trajectories()


def surface(name: str, **parameters: float) -> Surface:
    """The surface itself: closest points, signed distances and exact contacts in closed form."""
    return _touchstone._synthetic.surface(name, parameters)


def mesh(name: str, triangles: int = 10000, **parameters: float) -> Mesh:
    """A mesh of the surface with about `triangles` triangles; its vertices are on the surface."""
    return _touchstone._synthetic.mesh(name, parameters, triangles)[0]


def mesh_deviation_m(name: str, triangles: int = 10000, **parameters: float) -> float:
    """A bound of the distance between that mesh and the surface [m]."""
    return _touchstone._synthetic.mesh(name, parameters, triangles)[1]


def trajectory(name: str, rate_Hz: float = 1000.0, seed: int = 1, **parameters: float) -> Trajectory:
    """Positions over time [s], [m], sampled at `rate_Hz`. The same seed gives the same motion."""
    return Trajectory(*_touchstone._synthetic.path(name, parameters, rate_Hz, seed))
