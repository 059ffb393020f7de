"""Renderers written in Python: the class to derive from, and what the plug-in beside this file calls."""

import hashlib
import importlib.util
import os
import sys
import traceback
from pathlib import Path
from typing import Any, ClassVar, List, Mapping, NamedTuple, Optional, Sequence, Tuple, Type, TypeVar, Union

import numpy as np
from numpy.typing import NDArray


#: Three numbers.
Vector = Union[Sequence[float], NDArray[np.float64]]


class Parameter(NamedTuple):
    """A parameter that a model file may set."""

    name: str  #: with its unit: "stiffness_N_per_m"
    unit: str  #: "N/m"; "1" for a ratio. From it the tests know how the value changes with the unit of length
    minimum: float  #: inclusive
    maximum: float  #: inclusive
    default: float
    meaning: str  #: one line


class Tip(NamedTuple):
    """The tip at one servo tick, in the object's frame."""

    time_s: float
    position_m: NDArray[np.float64]  #: (3,); the centre of the ball where the tip is a ball
    orientation_wxyz: Tuple[float, float, float, float]  #: unit quaternion from the tip's frame to the object's


class Step(NamedTuple):
    """The answer to a tip, in the object's frame."""

    force_N: Vector  #: (3,) force on the probe by the object
    contact_m: Vector  #: (3,) surface contact point (god-object); the tip itself when free
    normal: Vector = (0.0, 0.0, 0.0)  #: (3,) outward unit normal of the contact; zero when free
    depth_m: float = 0.0  #: penetration along the normal, >= 0
    contact: bool = True

    @staticmethod
    def free(tip: Tip) -> "Step":
        """The answer in free space."""
        return Step((0.0, 0.0, 0.0), tip.position_m, contact=False)


class Renderer:
    """A haptic renderer. Derive from it, set `name`, and write `__init__`, `reset` and `step`.

    `__init__` gets `vertices_m`, float64 of shape (V, 3) in metres, and `triangles`, int32 of shape (T, 3),
    counter-clockwise seen from outside, and the declared parameters by their names. The same steps after `reset` must
    give the same results to the bit. An exception in a step ends the run, with its place in the message.
    """

    name: ClassVar[str]  #: as model files spell it
    summary: ClassVar[str] = "a renderer in Python"
    source: ClassVar[str] = "not given"  #: the publication that the algorithm follows
    parameters: ClassVar[Sequence[Parameter]] = ()
    #: What it cannot do, with the reason: the tests that demand it are skipped. Abilities: see `ABILITIES`.
    cannot: ClassVar[Mapping[str, str]] = {}
    #: The golden cases' model whose place it takes in the suite; None: no golden cases.
    golden_like: ClassVar[Optional[str]] = None
    #: What the suite must know besides: stiffness, friction, tip_radius, epsilon (see `touchstone-conformance --help`).
    facts: ClassVar[Mapping[str, float]] = {}

    def __init__(self, vertices_m: NDArray[np.float64], triangles: NDArray[np.int32], **parameters: float) -> None:
        raise NotImplementedError

    def reset(self) -> None:
        """Forgets everything: the next step is the first one of a run."""
        raise NotImplementedError

    def step(self, tip: Tip) -> Step:
        """One servo tick."""
        raise NotImplementedError


_AnyRenderer = TypeVar("_AnyRenderer", bound=Renderer)

#: What a renderer may declare that it cannot (harness/rendering/limitation.h).
ABILITIES = (
    "thin_shells",
    "large_jumps",
    "start_inside",
    "continuous_force",
    "rigid_motion",
    "unit_scale",
    "passive",
    "surface_contact",
    "ball_tip",
)

#: The environment variable that names the file of renderers for a program that is no Python.
FILE_VARIABLE = "TOUCHSTONE_PYTHON_RENDERER"

_registered: List[Type[Renderer]] = []
_file_loaded = False


def registered() -> List[Type[Renderer]]:
    """Every class that is known by its name."""
    return list(_registered)


def register(renderer: Type[_AnyRenderer]) -> Type[_AnyRenderer]:
    """Makes a class known by its name, in place of an earlier one of that name. Usable as a decorator."""
    if not getattr(renderer, "name", ""):
        raise TypeError(f"{renderer.__name__} has no name; set the class attribute `name`")
    for unknown in set(renderer.cannot) - set(ABILITIES):
        raise TypeError(f"{renderer.__name__}.cannot: there is no ability {unknown}; there are {', '.join(ABILITIES)}")
    for index, known in enumerate(_registered):
        if known.name == renderer.name:
            _registered[index] = renderer
            return renderer
    _registered.append(renderer)
    return renderer


def load_renderers(path: Union[str, "os.PathLike[str]"]) -> List[Type[Renderer]]:
    """Runs a Python file and registers every class of it that is a `Renderer` with a name. Returns them."""
    path = Path(path).resolve()
    # Two files of one name are two modules.
    module_name = f"touchstone_renderers_{hashlib.sha256(str(path).encode()).hexdigest()[:12]}"
    spec = importlib.util.spec_from_file_location(module_name, path)
    if spec is None or spec.loader is None:
        raise ImportError(f"{path}: is no Python file")
    module = importlib.util.module_from_spec(spec)
    sys.modules[module_name] = module
    spec.loader.exec_module(module)
    found = [
        thing
        for thing in vars(module).values()
        if isinstance(thing, type) and issubclass(thing, Renderer) and thing.__module__ == module_name
        and hasattr(thing, "name")
    ]
    if not found:
        raise ImportError(f"{path}: holds no class that derives from touchstone.Renderer and has a name")
    for renderer in found:
        register(renderer)
    return found


# --- What renderer_plugin.cc calls. ---


def _known() -> List[Type[Renderer]]:
    global _file_loaded
    path = os.environ.get(FILE_VARIABLE, "")
    if path and not _file_loaded:
        _file_loaded = True
        load_renderers(path)
    return _registered


def _description(index: int) -> Any:
    known = _known()
    if not known:
        raise RuntimeError(f"no renderer is registered; name a Python file in the environment variable {FILE_VARIABLE}")
    if index >= len(known):
        return None
    renderer = known[index]
    parameters = [
        (p.name, p.unit, float(p.minimum), float(p.maximum), float(p.default), p.meaning) for p in renderer.parameters
    ]
    return (renderer.name, renderer.summary, renderer.source, parameters, list(renderer.cannot.items()))


def _create(index: int, parameters: memoryview, vertices: memoryview, triangles: memoryview) -> "_Adapter":
    renderer = _known()[index]
    values = dict(zip((p.name for p in renderer.parameters), np.frombuffer(parameters, float).tolist()))
    # The mesh is the program's; a copy lives as long as the renderer wants it to.
    vertices_m = np.frombuffer(vertices, np.float64).reshape(-1, 3).copy()
    corners = np.frombuffer(triangles, np.int32).reshape(-1, 3).copy()
    return _Adapter(renderer(vertices_m, corners, **values))


class _Adapter:
    """Between eleven numbers in C and a `Step`."""

    __slots__ = ("_renderer",)

    def __init__(self, renderer: Renderer) -> None:
        self._renderer = renderer

    def reset(self) -> None:
        self._renderer.reset()

    def step(self, t: float, x: float, y: float, z: float, qw: float, qx: float, qy: float, qz: float) -> Tuple[float, ...]:
        answer = self._renderer.step(Tip(t, np.array((x, y, z)), (qw, qx, qy, qz)))
        if not isinstance(answer, Step):
            raise TypeError(f"step() returned {type(answer).__name__}; a touchstone.Step was expected")
        return (*answer.force_N, *answer.contact_m, *answer.normal, answer.depth_m, bool(answer.contact))


def _describe_exception(error: BaseException, trace: Any) -> str:
    frames = traceback.extract_tb(trace)
    own = [frame for frame in frames if frame.filename != __file__] or frames
    place = f" ({own[-1].filename}, line {own[-1].lineno})" if own else ""
    return f"{type(error).__name__}: {error}{place}"
