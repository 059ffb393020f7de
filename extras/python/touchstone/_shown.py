"""How data show themselves in a notebook: methods of the classes that the module in C++ defines."""

from typing import Any, List

import numpy as np

from . import _plots
from ._tables import table
from ._touchstone import Mesh, Recording, Rendered, Trajectory


def _describe(self: Any) -> str:
    return f"<{type(self).__name__}: {len(self)} samples>"


def _rows(self: Any) -> List[List[str]]:
    time = self.time_s
    rows = [["samples", f"{len(self)}"]]
    if len(self) > 0:
        rows.append(["time", f"{time[0]:.4g} s to {time[-1]:.4g} s"])
        low, high = self.position_m.min(axis=0), self.position_m.max(axis=0)
        rows.append(["tip", ", ".join(f"{a} {l * 1e3:.4g} to {h * 1e3:.4g} mm" for a, l, h in zip("xyz", low, high))])
    if len(self) > 1:
        rows.append(["median interval", f"{np.median(np.diff(time)) * 1e3:.4g} ms"])
    force = getattr(self, "force_N", None)
    if force is not None and len(self) > 0:
        rows.append(["largest force", f"{np.linalg.norm(force, axis=1).max():.4g} N"])
    return rows + [["note", note] for note in self.notes]


def _samples_html(self: Any) -> str:
    return table([type(self).__name__, getattr(self, "source", "")], _rows(self))


def _describe_mesh(self: Mesh) -> str:
    return f"<Mesh: {len(self)} triangles, {len(self.vertices_m)} vertices>"


def _mesh_html(self: Mesh) -> str:
    rows = [["triangles", str(len(self))], ["vertices", str(len(self.vertices_m))]]
    if len(self.vertices_m) > 0:
        size = np.ptp(self.vertices_m, axis=0) * 1e3
        rows.append(["size", " x ".join(f"{one:.4g}" for one in size) + " mm"])
    return table(["Mesh", self.source], rows)


def _plot_recording(self: Any, **options: Any) -> Any:
    """Position [mm] and force [N] over time. Returns matplotlib's figure; options go to `matplotlib.pyplot.subplots`."""
    return _plots.recording(self, **options)


def _plot_trajectory(self: Any, **options: Any) -> Any:
    """Position [mm] over time. Returns matplotlib's figure; options go to `matplotlib.pyplot.subplots`."""
    return _plots.trajectory(self, **options)


for _kind, _plot in ((Recording, _plot_recording), (Rendered, _plot_recording), (Trajectory, _plot_trajectory)):
    setattr(_kind, "__repr__", _describe)
    setattr(_kind, "_repr_html_", _samples_html)
    setattr(_kind, "plot", _plot)
setattr(Mesh, "__repr__", _describe_mesh)
setattr(Mesh, "_repr_html_", _mesh_html)
