"""Types of the module in C++ (extras/python/*.cc). Arrays are float64 if nothing else is said; those of files and results are
read-only views of the library's memory."""

import os
from typing import Any, Callable, Dict, List, Mapping, Optional, Sequence, Tuple, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

_Path = Union[str, "os.PathLike[str]"]
_Floats = NDArray[np.float64]

__version__: str

class Error(RuntimeError):
    """What the program says, and why."""

class BadData(Error):
    """A file that cannot be used; exit status 3 of the program."""

class UsageError(Error):
    """A wrong call; exit status 2 of the program."""

class RendererFailed(Error):
    """A renderer broke down; the message says at which step."""

class Recording:
    """What a probe measured: N samples in SI units, in the object's frame."""

    def __init__(self, time_s: ArrayLike, position_m: ArrayLike, force_N: ArrayLike, *,
                 orientation_xyzw: Optional[ArrayLike] = None, torque_Nm: Optional[ArrayLike] = None,
                 source: str = "") -> None: ...
    def __len__(self) -> int: ...
    @property
    def time_s(self) -> _Floats:
        """(N,) time [s], strictly increasing."""
    @property
    def position_m(self) -> _Floats:
        """(N, 3) position of the probe's tip [m]; the ball's centre if the tip is a ball."""
    @property
    def force_N(self) -> _Floats:
        """(N, 3) force on the probe by the object [N]."""
    @property
    def orientation_xyzw(self) -> Optional[_Floats]:
        """(N, 4) unit quaternions x, y, z, w from the sensor's frame to the object's; None if not recorded."""
    @property
    def torque_Nm(self) -> Optional[_Floats]:
        """(N, 3) torque about the tip [Nm]; None if not recorded."""
    @property
    def source(self) -> str:
        """The file that it came from."""
    @property
    def notes(self) -> List[str]:
        """What was tolerated or changed while reading, one sentence each."""
    @property
    def segment_starts(self) -> List[int]:
        """With on_gap='split': the first sample of each segment, beginning with 0; else empty."""
    @property
    def median_interval_s(self) -> float:
        """Median time between samples [s]; 0 if it was not read from a file."""
    def save(self, path: _Path, *, length_unit: str = "m", force_unit: str = "N", time_unit: str = "s",
             torque_unit: str = "Nm") -> None:
        """Writes CSV (.csv, .csv.gz) or HDF5 (.h5, .hdf5); in SI units it is read back to the bit."""
    def plot(self, **options: Any) -> Any:
        """Position [mm] and force [N] over time. Returns matplotlib's figure."""
    def _repr_html_(self) -> str: ...

class Trajectory:
    """Positions over time that a virtual probe takes: N samples in SI units, in the object's frame."""

    def __init__(self, time_s: ArrayLike, position_m: ArrayLike, *, orientation_xyzw: Optional[ArrayLike] = None) -> None: ...
    def __len__(self) -> int: ...
    @property
    def time_s(self) -> _Floats:
        """(N,) time [s], strictly increasing."""
    @property
    def position_m(self) -> _Floats:
        """(N, 3) position of the tip [m]."""
    @property
    def orientation_xyzw(self) -> Optional[_Floats]:
        """(N, 4) unit quaternions x, y, z, w; None if not known."""
    @property
    def notes(self) -> List[str]:
        """What was tolerated or changed while reading, one sentence each."""
    @property
    def segment_starts(self) -> List[int]:
        """With on_gap='split': the first sample of each segment, beginning with 0; else empty."""
    @property
    def median_interval_s(self) -> float:
        """Median time between samples [s]; 0 if it was not read from a file."""
    def save(self, path: _Path, *, length_unit: str = "m", force_unit: str = "N", time_unit: str = "s",
             torque_unit: str = "Nm") -> None:
        """Writes CSV (.csv, .csv.gz) or HDF5 (.h5, .hdf5); in SI units it is read back to the bit."""
    def plot(self, **options: Any) -> Any:
        """Position [mm] over time. Returns matplotlib's figure."""
    def _repr_html_(self) -> str: ...

class Rendered:
    """What a renderer made of a trajectory: N samples in SI units, in the object's frame."""

    def __len__(self) -> int: ...
    @property
    def time_s(self) -> _Floats:
        """(N,) time [s]."""
    @property
    def position_m(self) -> _Floats:
        """(N, 3) position of the tip [m]."""
    @property
    def contact_m(self) -> _Floats:
        """(N, 3) surface contact point [m]; the tip itself when free."""
    @property
    def force_N(self) -> _Floats:
        """(N, 3) force on the probe by the object [N]."""
    @property
    def contact(self) -> NDArray[np.uint8]:
        """(N,) 1 in contact, 0 free."""
    @property
    def step_us(self) -> Optional[_Floats]:
        """(N,) time that each step took [us]; None if steps were not timed."""
    @property
    def notes(self) -> List[str]:
        """What was tolerated or changed while reading, one sentence each."""
    @property
    def segment_starts(self) -> List[int]:
        """With on_gap='split': the first sample of each segment, beginning with 0; else empty."""
    @property
    def median_interval_s(self) -> float:
        """Median time between samples [s]; 0 if it was not read from a file."""
    def save(self, path: _Path, *, length_unit: str = "m", force_unit: str = "N", time_unit: str = "s",
             torque_unit: str = "Nm") -> None:
        """Writes CSV (.csv, .csv.gz) or HDF5 (.h5, .hdf5); in SI units it is read back to the bit."""
    def plot(self, **options: Any) -> Any:
        """Position [mm] and force [N] over time. Returns matplotlib's figure."""
    def _repr_html_(self) -> str: ...

class Mesh:
    """A triangle mesh in metres, counter-clockwise seen from outside."""

    def __init__(self, vertices_m: ArrayLike, triangles: ArrayLike, *, source: str = "") -> None: ...
    def __len__(self) -> int:
        """The number of triangles."""
    @property
    def vertices_m(self) -> _Floats:
        """(V, 3) corners [m]."""
    @property
    def triangles(self) -> NDArray[np.int32]:
        """(T, 3) indices of corners."""
    @property
    def source(self) -> str:
        """The file or generator that it came from."""
    def save(self, path: _Path, *, unit: str = "m") -> None:
        """Writes OBJ, OFF, PLY or STL, also .gz, with coordinates in `unit`."""
    def surface(self) -> Surface:
        """What can be asked of the mesh: closest points, signed distances and crossings."""
    def warnings(self) -> List[str]:
        """What is wrong with the mesh for rendering, a sentence each."""
    def _repr_html_(self) -> str: ...

class Surface:
    """A surface in the object's frame: of a mesh, or known in closed form."""

    def closest(self, points_m: ArrayLike) -> Dict[str, _Floats]:
        """For points of shape (N, 3) [m]: point_m (N, 3), the closest points of the surface; normal (N, 3), outward unit
        normals there; signed_distance_m (N,), negative inside."""
    def first_crossing(self, from_m: Sequence[float], to_m: Sequence[float]) -> Optional[Dict[str, Any]]:
        """The first crossing of the segment with the surface, from either side, or None."""
    def exact_contact(self, position_m: ArrayLike, *, stiffness_N_per_m: float,
                      tip_radius_m: float = 0.0) -> Dict[str, _Floats]:
        """The answer of a frictionless god-object at rest for tips of shape (N, 3) [m]: force_N (N, 3), contact_m (N, 3),
        depth_m (N,). Exact if the surface is."""

class Model:
    """A renderer with its parameters, contact effects and instrument entries: what a model file says."""

    @staticmethod
    def parse(text: str, source: str = "model") -> Model:
        """The model of a model file's text (JSON)."""
    @staticmethod
    def load(path: _Path) -> Model:
        """Reads a model file."""
    def to_json(self) -> str:
        """The text of its model file."""
    @property
    def renderer(self) -> str:
        """The renderer's name."""
    @property
    def parameters(self) -> Dict[str, float]:
        """Those that are set; names carry their units."""

def load_recording(path: _Path, *, on_duplicate: str = "refuse", on_gap: str = "keep") -> Recording:
    """Reads a recording (CSV, also .gz, or HDF5). Raises BadData naming the file, place, value and what was expected."""

def load_trajectory(path: _Path, *, on_duplicate: str = "refuse", on_gap: str = "keep") -> Trajectory:
    """Reads time and position of a file; other columns are checked and not used."""

def load_rendered(path: _Path, *, on_duplicate: str = "refuse", on_gap: str = "keep") -> Rendered:
    """Reads a rendered file: time, tip, force, surface contact point and contact."""

def load_mesh(path: _Path, *, unit: str = "m", repair: bool = False) -> Mesh:
    """Reads OBJ, OFF, PLY or STL, also .gz. `unit` is that of the file's coordinates; `repair` turns triangles that face the
    other way than most of their piece."""

def build_info() -> Dict[str, Any]:
    """Version, commit and state of the sources, compiler and flags."""

def describe_commands() -> Dict[str, Dict[str, Any]]: ...
def run_command(words: Sequence[str]) -> Tuple[int, str]: ...
def report_progress(call: Optional[Callable[[str, int, int], Any]]) -> None: ...
def replay(model: Model, mesh: Mesh, trajectory: Trajectory, time_steps: bool, two_sided: bool,
           plugins: Sequence[str]) -> Rendered: ...
def measure_steps(model: Model, mesh: Mesh, trajectory: Trajectory, two_sided: bool,
                  plugins: Sequence[str]) -> Dict[str, Union[int, float]]: ...

class _synthetic:
    @staticmethod
    def surfaces() -> List[Dict[str, Any]]: ...
    @staticmethod
    def trajectories() -> List[Dict[str, Any]]: ...
    @staticmethod
    def surface(name: str, parameters: Mapping[str, float]) -> Surface: ...
    @staticmethod
    def mesh(name: str, parameters: Mapping[str, float], triangles: int) -> Tuple[Mesh, float]: ...
    @staticmethod
    def path(name: str, parameters: Mapping[str, float], rate_Hz: float, seed: int) -> Tuple[_Floats, _Floats]: ...
