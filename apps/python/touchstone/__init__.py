"""Touchstone from Python: recordings and meshes as numpy arrays, every command of the program, results that show
themselves in a notebook, and renderers written in Python.

    import touchstone as ts
    recording = ts.load_recording("press.csv")
    evaluation = ts.evaluate(recording="press.csv", mesh="object.obj", mesh_unit="mm", model="god-object.json")
    evaluation.plot()

Units are SI, in the names; everything is in the object's frame; forces are those on the probe by the object.
"""

from typing import Any

from .renderer import ABILITIES, Parameter, Renderer, Step, Tip, load_renderers, register

# The rest is loaded when it is first asked for: a program that runs a renderer written in Python imports
# touchstone.renderer alone, and does not want the library a second time.
_RENDERER = ["ABILITIES", "Parameter", "Renderer", "Step", "Tip", "load_renderers", "register"]
_API = [
    "BadData", "Board", "Check", "Comparison", "Error", "Evaluation", "Evaluations", "Atlas", "Findings", "Fit", "Mesh",
    "Model", "Perception", "Recording", "Rendered", "RendererFailed", "Result", "Scorecard", "Surface", "Trajectory",
    "UsageError", "Skipped", "atlas", "build_info", "bundled", "check", "commands", "compare", "datasets", "discrepancy",
    "evaluate", "fit", "leaderboard", "load_mesh", "load_recording", "load_rendered", "load_result",
    "load_trajectory", "measure_steps", "model", "perceive", "progress", "replay", "run", "scorecard", "synthetic",
    "__version__",
]
__all__ = _RENDERER + _API


def __getattr__(name: str) -> Any:
    if name in _API:
        from . import _api

        return getattr(_api, name)
    raise AttributeError(f"module 'touchstone' has no attribute '{name}'")


def __dir__() -> list:
    return sorted(__all__)
