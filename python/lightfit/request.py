"""From arguments to messages. Whether a server or this process answers, requests are the same."""

from __future__ import annotations

import dataclasses
import math
from typing import Any, Dict, Iterable, Mapping, Optional, Sequence, Tuple, Union

from numpy.typing import ArrayLike

from lightfit.cover import FineCover, check_cover
from lightfit.errors import InvalidArgumentError
from lightfit.inputs import (
    AnyCamera,
    Clip,
    Lights,
    MapSize,
    Options,
    camera_message,
    clip_message,
    light_messages,
    map_size_message,
    matrix_message,
    number_of_texels,
    options_message,
)
from lightfit.pixels import Pixels, check_pixels
from lightfit.summary import Summary, add_summaries
from lightfit.v1 import (
    allocation_pb2,
    light_pb2,
    readback_pb2,
    result_pb2,
    service_pb2,
    shot_pb2,
)
from lightfit.words import chosen

# Of every light's map; or of several maps for each light.
SizeOrPlan = Union[MapSize, result_pb2.PlanOptions]


@dataclasses.dataclass(frozen=True)
class ReadbackParts:
    """A read-back on its way: header and lights as messages, pixels still as arrays."""

    header: readback_pb2.Readback
    lights: Tuple[light_pb2.Light, ...]
    pixels: Pixels


def readback_parts(
    depth: Any,
    shadow: Any,
    camera: AnyCamera,
    lights: Lights,
    source: str = "",
    facing: Any = None,
    mapped: Any = None,
    cover: Optional[FineCover] = None,
    background: Optional[float] = None,
) -> ReadbackParts:
    messages = light_messages(lights)
    pixels = check_pixels(depth, shadow, len(messages), facing, mapped)
    pixels = dataclasses.replace(pixels, cover=check_cover(cover, len(messages)))
    header = pixels.header()
    header.camera.CopyFrom(camera_message(camera, pixels.width, pixels.height))
    header.source = source
    if background is not None:
        header.background = _depth_of(background)
    return ReadbackParts(header, messages, pixels)


def optional_parts(
    depth: Any,
    shadow: Any,
    camera: Optional[AnyCamera],
    lights: Optional[Lights],
    source: str,
    facing: Any = None,
    mapped: Any = None,
    cover: Optional[FineCover] = None,
    background: Optional[float] = None,
) -> Optional[ReadbackParts]:
    """None where there is none of it."""
    if all(part is None for part in (depth, shadow, camera, lights)):
        return None
    given_camera: Any = camera  # says what it wants when it is missing, as the others do
    return readback_parts(
        depth, shadow, given_camera, lights or (), source, facing, mapped, cover, background
    )


def _depth_of(background: Any) -> float:
    try:
        depth = float(background)
    except (TypeError, ValueError):
        depth = math.nan
    if not depth > 0:
        raise InvalidArgumentError(
            f"background = {background!r}, want the depth at and beyond which nothing was hit, or "
            "math.inf"
        )
    return depth


def fit_request(
    parts: ReadbackParts,
    size: SizeOrPlan,
    options: Optional[Options],
    clip: Clip,
    foretell_wrong: bool,
) -> service_pb2.FitRequest:
    """Without pixels."""
    return service_pb2.FitRequest(
        readback=parts.header,
        lights=parts.lights,
        **_size_fields(size),
        options=options_message(options),
        clip=clip_message(clip),
        foretell_wrong=foretell_wrong,
    )


def _size_fields(size: SizeOrPlan) -> Dict[str, Any]:
    if isinstance(size, result_pb2.PlanOptions):
        return {"plan_options": size}
    return {"map": map_size_message(size)}


def summary_request(
    summaries: Sequence[Summary], map_size: MapSize, options: Optional[Options], clip: Clip
) -> service_pb2.FitSummaryRequest:
    request = service_pb2.FitSummaryRequest(
        map=map_size_message(map_size), options=options_message(options), clip=clip_message(clip)
    )
    add_summaries(summaries, request)
    return request


@dataclasses.dataclass(frozen=True)
class Candidate:
    """A matrix to be evaluated."""

    message: service_pb2.CandidateMatrix

    @classmethod
    def map(cls, light: str, map_from_world: ArrayLike, map_size: MapSize) -> "Candidate":
        """light: the name of one of the lights. map_from_world: (4, 4), as in LightResult; its
        third row does not matter. map_size: (width, height), texels."""
        return cls(
            service_pb2.CandidateMatrix(
                light=light,
                map_from_world=matrix_message(map_from_world, f'light "{light}": map_from_world'),
                map=map_size_message(map_size),
            )
        )

    @classmethod
    def clip(
        cls, light: str, clip_from_world: ArrayLike, map_size: MapSize, *, clip: Clip
    ) -> "Candidate":
        """clip_from_world: (4, 4), column vectors, in the convention `clip`."""
        field = f'light "{light}": clip_from_world'
        return cls(
            service_pb2.CandidateMatrix(
                light=light,
                clip_from_world=matrix_message(clip_from_world, field),
                clip=clip_message(clip),
                map=map_size_message(map_size),
            )
        )


def evaluate_request(
    parts: ReadbackParts, matrices: Iterable[Candidate], options: Optional[Options]
) -> service_pb2.EvaluateRequest:
    request = service_pb2.EvaluateRequest(
        readback=parts.header, lights=parts.lights, options=options_message(options)
    )
    for index, candidate in enumerate(matrices):
        if not isinstance(candidate, Candidate):
            raise InvalidArgumentError(
                f"matrices[{index}]: is a {type(candidate).__name__}, want lightfit.Candidate, "
                'such as Candidate.map("sun", map_from_world, (1024, 1024))'
            )
        request.matrices.append(candidate.message)
    parts.pixels.fill(request.readback)
    return request


@dataclasses.dataclass(frozen=True)
class Tolerance:
    """What a texel may be on the final image at most.

    limit_px: pixels of the final image per texel.
    image_scale: pixels of the final image per pixel of the read-back.
    kind: of the samples' footprints: "rms", "p99" or "worst".

    Tolerance.parse("p99:1.5") takes the words of `lightfit allocate --tolerance`.
    """

    limit_px: float
    image_scale: float = 1.0
    kind: str = "p99"

    @classmethod
    def parse(cls, words: str, image_scale: float = 1.0) -> "Tolerance":
        """words: "rms:PIXELS", "p99:PIXELS" or "worst:PIXELS"."""
        kind, _, limit = words.partition(":")
        try:
            return cls(float(limit), image_scale, kind)
        except ValueError:
            raise InvalidArgumentError(
                f'tolerance = {words!r}, want rms:PIXELS, p99:PIXELS or worst:PIXELS, such as '
                '"p99:1.5"'
            ) from None

    @property
    def message(self) -> allocation_pb2.Tolerance:
        kind = chosen("tolerance: kind", self.kind, ("rms", "p99", "worst"), {})
        return allocation_pb2.Tolerance(
            kind=allocation_pb2.Tolerance.Kind.Value(f"KIND_{kind.upper()}"),
            limit_px=self.limit_px,
            image_scale=self.image_scale,
        )


def allocate_request(
    parts: Optional[ReadbackParts],
    summaries: Optional[Sequence[Summary]],
    budget_texels: Union[int, str, None],
    tolerance: Union[Tolerance, str, None],
    weights: Optional[Mapping[str, float]],
    rules: Optional[allocation_pb2.MapSizeRules],
    plan: Optional[result_pb2.PlanOptions],
    options: Optional[Options],
    clip: Clip,
) -> service_pb2.AllocateRequest:
    if (budget_texels is None) == (tolerance is None):
        raise InvalidArgumentError(
            "allocate: want either budget_texels, such as 4 * 1024 * 1024, or tolerance, such as "
            "lightfit.Tolerance(1.0) or \"p99:1.5\""
        )
    if isinstance(tolerance, str):
        tolerance = Tolerance.parse(tolerance)
    request = service_pb2.AllocateRequest(
        options=options_message(options),
        clip=clip_message(clip),
        rules=rules,
        plan_options=plan,
        tolerance=tolerance.message if tolerance is not None else None,
        weights=[
            service_pb2.LightWeight(light=light, weight=weight)
            for light, weight in (weights or {}).items()
        ],
    )
    if budget_texels is not None:
        request.budget_texels = number_of_texels(budget_texels, "budget_texels")
    if parts is not None:
        request.readback.CopyFrom(parts.header)
        request.lights.extend(parts.lights)
        parts.pixels.fill(request.readback)
    add_summaries(summaries or (), request)
    return request


def track_setup(
    size: SizeOrPlan,
    stability: Optional[float],
    tracker: Union[shot_pb2.TrackerSettings, shot_pb2.PlanTrackerSettings, None],
    options: Optional[Options],
    clip: Clip,
    state: Sequence[shot_pb2.TrackedState],
) -> service_pb2.TrackSetup:
    if stability is not None and tracker is not None:
        raise InvalidArgumentError("track: want stability or tracker, not both")
    setup = service_pb2.TrackSetup(
        **_size_fields(size),
        options=options_message(options),
        clip=clip_message(clip),
        state=state,
    )
    if isinstance(tracker, shot_pb2.TrackerSettings):
        setup.tracker.CopyFrom(tracker)
    elif tracker is not None:
        setup.plan_tracker.CopyFrom(tracker)
    if stability is not None:
        setup.stability = stability
    return setup


def track_frame(number: int, parts: ReadbackParts) -> service_pb2.TrackFrame:
    """Without pixels."""
    return service_pb2.TrackFrame(number=number, readback=parts.header, lights=parts.lights)
