"""What can be asked of lightfit: one class with all the calls, whoever answers them."""

from __future__ import annotations

from typing import Any, Iterable, Mapping, Optional, Sequence, Union

from lightfit.cover import FineCover
from lightfit.inputs import (
    AnyCamera,
    Clip,
    Lights,
    MapSize,
    Options,
    Path_,
    PlanOptions,
    plan_message,
)
from lightfit.request import (
    Candidate,
    ReadbackParts,
    Tolerance,
    allocate_request,
    evaluate_request,
    fit_request,
    readback_parts,
    summary_request,
    track_setup,
)
from lightfit.result import Allocation, EvaluateResult, FitResult
from lightfit.shot_calls import ShotCalls
from lightfit.summary import Summary
from lightfit.tracks import Track
from lightfit.v1 import allocation_pb2, shot_pb2


class Calls(ShotCalls):
    """The calls. Arguments that all of them share:

    timeout_s: seconds until DeadlineError, in all. None: as the Client was told; without a server,
        no limit.
    request_id: up to 128 printable ASCII characters that name the call in logs and errors. None:
        one is made up for a server.

    What is wrong with the call as a whole raises LightfitError, see lightfit.errors; arguments that
    are wrong by themselves raise InvalidArgumentError, a ValueError, before anything is sent.
    """

    def fit(
        self,
        depth: Any,
        shadow: Any,
        camera: AnyCamera,
        lights: Lights,
        map_size: MapSize,
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
        """The matrices of a read-back's lights.

        depth: (height, width) float32 or float16, top row first, of the kind that the camera says.
            Background is 1e9 or more, infinity, or the far plane, see `background`; single bad
            values are ignored.
        shadow: (height, width) uint32, bit l is 1 where light l is blocked; or (lights, height,
            width), one plane per light: bool, or uint8 with 255 where it is blocked.
        camera: `Camera.from_matrices(...)`, or a lightfit.v1 Camera message.
        lights: 1 to 32, `Light.sun(...)`, `Light.point(...)`, dicts such as {"name": "key",
            "position": [3, 1, 4]}, messages; or the path of a lights file. Names differ.
        map_size: (width, height) of every light's map, texels, or "1024x1024".
        options: every choice of a fit, None for the defaults: a dict such as {"search": "focused",
            "metric": "l1-edge", "margin_texels": 2}, with the words of the command line, or a
            lightfit.v1 FitOptions message. {"border": "lit"}, the default, "dark" or "auto": what
            look-ups outside the map find, see LightResult.border.
        clip: convention of LightResult.clip_from_world: "vulkan", "direct3d" (also "metal",
            "webgpu"), "opengl", "reversed-z" (Vulkan's), "direct3d-reversed" (also "metal-reversed",
            "webgpu-reversed"); in any case.
        foretell_wrong: whether LightResult.foretold_wrong is wanted.
        facing: which surfaces face the light, by the sign of the renderer's cosine: as shadow, 1,
            True or 255 where they do; or one (height, width) plane per light, None where it is not
            known. Optional; "auto" needs it.
        mapped: likewise, what the map that is drawn with says: 1 where it finds shadow. Optional.
        cover: the same frame with more pixels, `FineCover(depth, shadow)`: what is thinner than a
            pixel of the read-back has room in the map then. Optional.
        background: of depths that are distances, the one at and beyond which nothing was hit, such
            as 65504; math.inf: none but 1e9 or more. None: one greatest depth that many pixels
            share, far beyond the rest, is taken for it, with a warning.
        source: where the read-back came from; comes back in result.message.readback.source.

        What may be a mistake, as a sky that was taken for background or shadows that do not belong
        to the lights, is a LightfitWarning, and stands in result.message.readback.warnings.

        Each light has its own status: a light without a matrix does not raise.
        """
        parts = readback_parts(
            depth, shadow, camera, lights, source, facing, mapped, cover, background
        )
        request = fit_request(parts, map_size, options, clip, foretell_wrong)
        return FitResult.of(self._fit(request, parts.pixels, timeout_s, request_id))

    def fit_exr(
        self,
        path: Path_,
        lights: Lights,
        map_size: MapSize,
        *,
        options: Optional[Options] = None,
        clip: Clip = "vulkan",
        foretell_wrong: bool = False,
        timeout_s: Optional[float] = None,
        request_id: Optional[str] = None,
        **exr: Any,
    ) -> FitResult:
        """`fit` of an EXR read-back, as `lightfit fit PATH --lights LIGHTS` does it.

        The file is read here, also for a server. exr: the further arguments of `lightfit.read_exr`
        (camera, depth_kind, depth_channel, shadow_channel, camera_convention, cover ...). A light
        without a shadow channel has its own status.
        """
        return self._fit_exr(
            path, lights, map_size, options, clip, foretell_wrong, timeout_s, request_id, exr
        )

    def fit_summary(
        self,
        summaries: Sequence[Summary],
        map_size: MapSize,
        *,
        options: Optional[Options] = None,
        clip: Clip = "vulkan",
        timeout_s: Optional[float] = None,
        request_id: Optional[str] = None,
    ) -> FitResult:
        """One matrix per light for all the frames that summaries were made of.

        summaries: results of `summarize`; files of `lightfit summarize` by name, or their bytes, or
            SummaryFile messages; all of the same lights and options. They are added up.
        options: the search; samples, metric, cover and border are those of the summaries.
        map_size, clip: as for `fit`.
        """
        request = summary_request(summaries, map_size, options, clip)
        return FitResult.of(self._call("FitSummary", request, timeout_s, request_id))

    def track(
        self,
        map_size: MapSize,
        *,
        stability: Optional[float] = None,
        tracker: Optional[shot_pb2.TrackerSettings] = None,
        options: Optional[Options] = None,
        clip: Clip = "vulkan",
        state: Sequence[shot_pb2.TrackedState] = (),
        timeout_s: Optional[float] = None,
        request_id: Optional[str] = None,
    ) -> Track:
        """A sequence of frames whose matrices are kept while they are good enough.

        stability: 0 (every frame has the tightest map, and crawls) ... 1 (a matrix stays as long as
            it is valid). None: 0.5.
        tracker: instead, every choice of the rule as a lightfit.v1 TrackerSettings message.
        state: `Track.state` of an earlier sequence, to go on from there.
        timeout_s: of each frame.
        map_size, options, clip: as for `fit`.

            with lightfit.track((1024, 1024), stability=0.5) as track:
                result = track.update(1, depth, shadow, camera, lights)
        """
        setup = track_setup(map_size, stability, tracker, options, clip, state)
        track = self._track(setup, timeout_s, request_id)
        track.state = tuple(state)
        return track

    def evaluate(
        self,
        depth: Any,
        shadow: Any,
        camera: AnyCamera,
        lights: Lights,
        matrices: Iterable[Candidate],
        *,
        options: Optional[Options] = None,
        facing: Any = None,
        mapped: Any = None,
        cover: Optional[FineCover] = None,
        background: Optional[float] = None,
        source: str = "",
        timeout_s: Optional[float] = None,
        request_id: Optional[str] = None,
    ) -> EvaluateResult:
        """How good the caller's own matrices are.

        matrices: any number per light, `Candidate.map("sun", map_from_world, (1024, 1024))` or
            `Candidate.clip("sun", clip_from_world, (1024, 1024), clip="opengl")`.
        depth, shadow, camera, lights, options, facing, mapped, cover, background: as for `fit`.
        """
        parts = readback_parts(
            depth, shadow, camera, lights, source, facing, mapped, cover, background
        )
        request = evaluate_request(parts, matrices, options)
        return EvaluateResult.of(self._call("Evaluate", request, timeout_s, request_id))

    def allocate(
        self,
        depth: Any = None,
        shadow: Any = None,
        camera: Optional[AnyCamera] = None,
        lights: Optional[Lights] = None,
        *,
        summaries: Optional[Sequence[Summary]] = None,
        budget_texels: Union[int, str, None] = None,
        tolerance: Union[Tolerance, str, None] = None,
        weights: Optional[Mapping[str, float]] = None,
        rules: Optional[allocation_pb2.MapSizeRules] = None,
        plan: Optional[PlanOptions] = None,
        options: Optional[Options] = None,
        clip: Clip = "vulkan",
        facing: Any = None,
        mapped: Any = None,
        cover: Optional[FineCover] = None,
        background: Optional[float] = None,
        source: str = "",
        timeout_s: Optional[float] = None,
        request_id: Optional[str] = None,
    ) -> Allocation:
        """Sizes of shadow maps, from a read-back (as for `fit`) or from summaries.

        budget_texels: of all maps together, a number or "4096x4096", split so that the lights'
            energies are least; or
        tolerance: the smallest maps that keep `Tolerance(limit_px, image_scale, kind)`, or the words
            of `lightfit allocate --tolerance`, "p99:1.5".
        weights: by light, > 0, what its energy counts in a budget; 1 for those that are not named.
        rules: of the sides, a lightfit.v1 MapSizeRules message. None: multiples of 64 from 64 to
            16384.
        plan: several maps for each light, which the budget is divided among, LightResult.plan: as
            for `fit_plan`, without "texels" and "each", and with "sizes" instead of rules, such as
            {"max_maps": 4, "sizes": {"powers_of_two": True}}. With a read-back and budget_texels;
            {} for the defaults. None: one map for each light.
        """
        parts: Optional[ReadbackParts] = None
        if any(part is not None for part in (depth, shadow, camera, lights)):
            given_camera: Any = camera  # says what it wants when it is missing, as the others do
            parts = readback_parts(
                depth,
                shadow,
                given_camera,
                lights or (),
                source,
                facing,
                mapped,
                cover,
                background,
            )
        request = allocate_request(
            parts,
            summaries,
            budget_texels,
            tolerance,
            weights,
            rules,
            None if plan is None else plan_message(plan),
            options,
            clip,
        )
        return Allocation.of(self._call("Allocate", request, timeout_s, request_id))
