"""lightfit fits light matrices: read-backs as numpy arrays in, one 4x4 matrix per light out.

    import lightfit
    from lightfit import Camera, Light

    camera = Camera.from_matrices(camera_from_world, clip_from_camera, clip="opengl")
    lights = [Light.sun("sun", (-0.3, 0.2, -1)), Light.point("key", (3, 1, 4))]
    result = lightfit.fit(depth, shadow, camera, lights, (1024, 1024))
    result["sun"].clip_from_world

fit_plan gives each light several maps. All the calls, fit, fit_plan, track, track_plan, shot,
summarize, fit_summary, compare, evaluate, allocate and those of EXR files, compute in this process. lightfit.Client has
the same calls, answered by a server (`lightfit serve`), with the same results.

Matrices are (4, 4) float64 for column vectors and named target_from_source. World units are the
caller's; images are row-major, top row first; maps are in texels.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from lightfit.errors import (
    BusyError,
    CancelledError,
    Code,
    DeadlineError,
    FailedPreconditionError,
    InvalidArgumentError,
    LightfitError,
    LightfitWarning,
    TooLargeError,
    UnavailableError,
)
from lightfit._version import __version__
from lightfit.calls import Calls
from lightfit.comparison import ComparedLight, ComparedMethod, ComparedTotal, Comparison
from lightfit.cover import FineCover
from lightfit.exr import ExrReadback, read_exr
from lightfit.inputs import Camera, Light
from lightfit.local import Local
from lightfit.request import Candidate, Tolerance
from lightfit.messages import Footprint
from lightfit.plan import Plan, PlanMap
from lightfit.result import (
    Allocation,
    EvaluateResult,
    Evaluation,
    FitResult,
    LightResult,
    Samples,
    Status,
)
from lightfit.shots import ExrFrames, Frame, ShotStep
from lightfit.summary import FrameSummary, SummarizedLight
from lightfit.tracks import Track
from lightfit.v1.allocation_pb2 import MapSizeRules
from lightfit.v1.matrix_pb2 import ClipConvention
from lightfit.v1.options_pb2 import FitOptions
from lightfit.v1.result_pb2 import PlanOptions
from lightfit.v1.shot_pb2 import PlanTrackerSettings, TrackerSettings

if TYPE_CHECKING:
    from lightfit.channel import TlsOptions
    from lightfit.client import Client

_local = Local()
fit = _local.fit
fit_exr = _local.fit_exr
fit_plan = _local.fit_plan
fit_plan_exr = _local.fit_plan_exr
fit_summary = _local.fit_summary
track = _local.track
track_plan = _local.track_plan
summarize = _local.summarize
summarize_exr = _local.summarize_exr
compare = _local.compare
compare_exr = _local.compare_exr
shot = _local.shot
evaluate = _local.evaluate
allocate = _local.allocate

__all__ = [
    "Allocation",
    "BusyError",
    "Calls",
    "Camera",
    "CancelledError",
    "Candidate",
    "Client",
    "ClipConvention",
    "Code",
    "ComparedLight",
    "ComparedMethod",
    "ComparedTotal",
    "Comparison",
    "DeadlineError",
    "EvaluateResult",
    "Evaluation",
    "ExrFrames",
    "ExrReadback",
    "FailedPreconditionError",
    "FineCover",
    "FitOptions",
    "FitResult",
    "Footprint",
    "Frame",
    "FrameSummary",
    "InvalidArgumentError",
    "Light",
    "LightResult",
    "LightfitError",
    "LightfitWarning",
    "Local",
    "MapSizeRules",
    "Plan",
    "PlanMap",
    "PlanOptions",
    "PlanTrackerSettings",
    "Samples",
    "ShotStep",
    "Status",
    "SummarizedLight",
    "TlsOptions",
    "Tolerance",
    "TooLargeError",
    "Track",
    "TrackerSettings",
    "UnavailableError",
    "__version__",
    "allocate",
    "compare",
    "compare_exr",
    "evaluate",
    "fit",
    "fit_exr",
    "fit_plan",
    "fit_plan_exr",
    "fit_summary",
    "read_exr",
    "shot",
    "summarize",
    "summarize_exr",
    "track",
    "track_plan",
]


def __getattr__(name: str) -> Any:
    # gRPC is loaded by those who call servers.
    if name == "Client":
        from lightfit.client import Client

        return Client
    if name == "TlsOptions":
        from lightfit.channel import TlsOptions

        return TlsOptions
    raise AttributeError(f"module 'lightfit' has no attribute {name!r}")
