"""Types of the names of `touchstone`; see __init__.py."""

from . import synthetic as synthetic
from ._commands import (
    atlas as atlas,
    check as check,
    compare as compare,
    discrepancy as discrepancy,
    evaluate as evaluate,
    fit as fit,
    leaderboard as leaderboard,
    perceive as perceive,
    scorecard as scorecard,
)
from ._data import (
    DataSet as DataSet,
    Golden as Golden,
    datasets as datasets,
    goldens as goldens,
)
from ._models import (
    measure_steps as measure_steps,
    model as model,
    replay as replay,
)
from ._programs import (
    bundled as bundled,
)
from ._progress import (
    progress as progress,
)
from ._results import (
    Atlas as Atlas,
    Board as Board,
    Check as Check,
    Comparison as Comparison,
    Evaluation as Evaluation,
    Evaluations as Evaluations,
    Findings as Findings,
    Fit as Fit,
    JsonResult as JsonResult,
    Perception as Perception,
    Scorecard as Scorecard,
    load_result as load_result,
)
from ._run import (
    Result as Result,
    Skipped as Skipped,
    commands as commands,
    run as run,
)
from ._touchstone import (
    BadData as BadData,
    Error as Error,
    Mesh as Mesh,
    Model as Model,
    Recording as Recording,
    Rendered as Rendered,
    RendererFailed as RendererFailed,
    Surface as Surface,
    Trajectory as Trajectory,
    UsageError as UsageError,
    __version__ as __version__,
    build_info as build_info,
    load_mesh as load_mesh,
    load_recording as load_recording,
    load_rendered as load_rendered,
    load_trajectory as load_trajectory,
)
from .renderer import (
    ABILITIES as ABILITIES,
    Parameter as Parameter,
    Renderer as Renderer,
    Step as Step,
    Tip as Tip,
    load_renderers as load_renderers,
    register as register,
)

__all__: list[str]
