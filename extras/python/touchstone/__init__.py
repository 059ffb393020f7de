"""Touchstone from Python: recordings and meshes as numpy arrays, every command of the program, results that show
themselves in a notebook, and renderers written in Python.

    import touchstone as ts
    recording = ts.load_recording("press.csv")
    evaluation = ts.evaluate(recording="press.csv", mesh="object.obj", mesh_unit="mm", model="god-object.json")
    evaluation.plot()

Units are SI, in the names; everything is in the object's frame; forces are those on the probe by the object.
"""

from importlib import import_module
from typing import Any, List

from .renderer import ABILITIES, Parameter, Renderer, Step, Tip, load_renderers, register

# The rest is loaded when it is first asked for: a program that runs a renderer written in Python imports
# touchstone.renderer alone, and does not want the library a second time. Types: __init__.pyi.
_PLACES = {
    "_touchstone": ["BadData", "Error", "Mesh", "Model", "Recording", "Rendered", "RendererFailed", "Surface", "Trajectory",
                    "UsageError", "__version__", "build_info", "load_mesh", "load_recording", "load_rendered",
                    "load_trajectory"],
    "_commands": ["atlas", "check", "compare", "discrepancy", "evaluate", "fit", "leaderboard", "perceive", "scorecard"],
    "_data": ["DataSet", "Golden", "datasets", "goldens"],
    "_models": ["measure_steps", "model", "replay"],
    "_programs": ["bundled"],
    "_progress": ["progress"],
    "_results": ["Atlas", "Board", "Check", "Comparison", "Evaluation", "Evaluations", "Findings", "Fit", "JsonResult",
                 "Perception", "Scorecard", "load_result"],
    "_run": ["Result", "Skipped", "commands", "run"],
}
_MODULE_OF = {name: module for module, names in _PLACES.items() for name in names}
__all__ = ["ABILITIES", "Parameter", "Renderer", "Step", "Tip", "load_renderers", "register", "synthetic", *_MODULE_OF]


def __getattr__(name: str) -> Any:
    if name != "synthetic" and name not in _MODULE_OF:
        raise AttributeError(f"module 'touchstone' has no attribute '{name}'")
    for needed in ("_progress", "_shown"):
        import_module(f".{needed}", __name__)
    if name == "synthetic":
        return import_module(".synthetic", __name__)
    return getattr(import_module(f".{_MODULE_OF[name]}", __name__), name)


def __dir__() -> List[str]:
    return sorted(__all__)
