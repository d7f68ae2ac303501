"""The calls for several maps of each light."""

from __future__ import annotations

from typing import Any, Optional, Sequence

from lightfit.answers import Answers
from lightfit.cover import FineCover
from lightfit.inputs import AnyCamera, Clip, Lights, Options, Path_, PlanOptions, plan_message
from lightfit.request import fit_request, readback_parts, track_setup
from lightfit.result import FitResult
from lightfit.tracks import Track
from lightfit.v1 import shot_pb2


class PlanCalls(Answers):
    """Arguments that calls share: see Calls."""

    def fit_plan(
        self,
        depth: Any,
        shadow: Any,
        camera: AnyCamera,
        lights: Lights,
        plan: Optional[PlanOptions] = None,
        *,
        options: Optional[Options] = None,
        clip: Clip = "vulkan",
        foretell_wrong: bool = False,
        facing: Any = None,
        mapped: Any = None,
        cover: Optional[FineCover] = None,
        background: Optional[float] = None,
        source: str = "",
        timeout_s: Optional[float] = None,
        request_id: Optional[str] = None,
    ) -> FitResult:
        """Several maps for each light, of which a receiver asks the densest: LightResult.plan.

        plan: how many maps, and of which sizes, None for the defaults: a dict such as {"max_maps":
            4, "texels": 1024 * 1024}, of all maps of a light together; {"max_maps": 4, "each":
            (512, 512)} for maps of one size; or a lightfit.v1 PlanOptions message. "guard_texels":
            half the width of the filter. "choose_by_forecast": False for "max_maps" maps in any
            case.
        options: as for `fit`, but for "search" and "affine".
        The rest: as for `fit`.

        A lamp among its receivers, which no single map serves, has a plan: its status says how many
        maps would do where there are too few.
        """
        parts = readback_parts(
            depth, shadow, camera, lights, source, facing, mapped, cover, background
        )
        request = fit_request(parts, plan_message(plan), options, clip, foretell_wrong)
        return FitResult.of(self._fit(request, parts.pixels, timeout_s, request_id))

    def fit_plan_exr(
        self,
        path: Path_,
        lights: Lights,
        plan: Optional[PlanOptions] = None,
        *,
        options: Optional[Options] = None,
        clip: Clip = "vulkan",
        foretell_wrong: bool = False,
        timeout_s: Optional[float] = None,
        request_id: Optional[str] = None,
        **exr: Any,
    ) -> FitResult:
        """`fit_plan` of an EXR read-back, as `lightfit fit PATH --lights LIGHTS --maps N` does it.

        exr: as for `fit_exr`.
        """
        size = plan_message(plan)
        return self._fit_exr(
            path, lights, size, options, clip, foretell_wrong, timeout_s, request_id, exr
        )

    def track_plan(
        self,
        plan: Optional[PlanOptions] = None,
        *,
        stability: Optional[float] = None,
        tracker: Optional[shot_pb2.PlanTrackerSettings] = None,
        options: Optional[Options] = None,
        clip: Clip = "vulkan",
        state: Sequence[shot_pb2.TrackedState] = (),
        timeout_s: Optional[float] = None,
        request_id: Optional[str] = None,
    ) -> Track:
        """A sequence of frames whose plans are kept while they are good enough, each map by itself.

        plan: as for `fit_plan`.
        tracker: every choice of the rule as a lightfit.v1 PlanTrackerSettings message.
        The rest: as for `track`. PlanMap.action and frames_kept say what became of each map.
        """
        setup = track_setup(plan_message(plan), stability, tracker, options, clip, state)
        track = self._track(setup, timeout_s, request_id)
        track.state = tuple(state)
        return track
