"""What calls give: plain dataclasses over the messages. Every `message` is the protobuf message,
with all fields of the schema."""

from __future__ import annotations

import dataclasses
import warnings
from typing import Dict, List, Optional, Tuple

from lightfit.errors import Code, LightfitWarning, error_of
from lightfit.messages import (
    Footprint,
    Matrix,
    footprint_of,
    lower_word,
    matrix_of,
    optional,
    word_of,
)
from lightfit.plan import Plan
from lightfit.v1 import (
    allocation_pb2,
    matrix_pb2,
    result_pb2,
    service_pb2,
    shot_pb2,
)


@dataclasses.dataclass(frozen=True)
class Status:
    """code: "OK", "INVALID_ARGUMENT", "FAILED_PRECONDITION" (no single map exists for this light, or
    it has no shadow edge in view) ... message: what is wrong and what to do about it."""

    code: str
    message: str

    @property
    def ok(self) -> bool:
        return self.code == "OK"

    def __str__(self) -> str:
        return self.message if self.message else self.code


@dataclasses.dataclass(frozen=True)
class Samples:
    """Read-back pixels, by what became of them."""

    receivers: int  # with a surface
    invalid_depth: int  # NaN, negative or out of range: ignored
    candidates: int  # next to a shadow edge; the counts below split these
    background: int
    discontinuity: int
    facing_away: int
    edge_on: int
    used: int
    beyond_map: int  # far outside what a map with a dark border must cover


@dataclasses.dataclass(frozen=True, eq=False)
class LightResult:
    """One light. Matrices and figures are None when it is not ok."""

    name: str
    status: Status
    map_size: Tuple[int, int]  # (width, height), texels

    # (4, 4), column vectors. (u w, v w, z w, w) = map_from_world @ (x, y, z, 1): u right and v down
    # in texels, (0, 0) the corner of the first texel; z 0 ... 1 from the nearest to the farthest
    # receiver.
    map_from_world: Optional[Matrix]

    # (4, 4): the same for a renderer, clip space in the convention that was asked for.
    clip_from_world: Optional[Matrix]

    # What look-ups outside the map must find, w <= 0 included: "lit" or "dark". "lit" unless options
    # ask for another border. And how the fit knew which surfaces face the light: "given" by the
    # read-back or "guessed" from its depth; None where there was none.
    border: Optional[str]
    facing: Optional[str]

    # Sum over the samples of weight times footprint. Comparable between maps of one size on one
    # read-back only.
    energy: Optional[float]
    footprint: Optional[Footprint]
    samples: Optional[Samples]
    evaluations: int  # matrices that the search looked at
    stop_reason: str  # "CONVERGED", "ROUND_LIMIT", "AXIS_AT_LIMIT", "NO_SEARCH"
    foretold_wrong: Optional[float]  # share of the image's pixels, 0 ... 1; None unless asked for

    # In a track: what became of the matrix of the frame before ("FIRST", "KEPT", "SHIFTED",
    # "RELAID", "REPLACED", "INVALID"), and for how many frames texels have not moved over surfaces.
    action: Optional[str]
    frames_kept: Optional[int]

    # Where several maps were asked for (`fit_plan`, `track_plan`): the answer, of one map or more.
    # Of several there is no single matrix: map_size is (0, 0), matrices are None, and energy,
    # footprint and samples are the plan's. In a track its maps have their own action.
    plan: Optional[Plan]

    message: result_pb2.LightResult = dataclasses.field(repr=False)

    @property
    def ok(self) -> bool:
        return self.status.ok

    @classmethod
    def of(cls, message: result_pb2.LightResult) -> "LightResult":
        status = status_of(message.status)
        ok = status.ok
        shot = message.shot if message.HasField("shot") else None
        shot_plan = shot.plan if shot is not None and shot.HasField("plan") else None
        tracked = shot is not None and shot_plan is None
        return cls(
            name=message.name,
            status=status,
            map_size=(message.map.width, message.map.height),
            map_from_world=matrix_of(message.map_from_world) if ok else None,
            clip_from_world=matrix_of(message.clip_from_world) if ok else None,
            border=lower_word(matrix_pb2.Border, message.border, "BORDER_"),
            facing=lower_word(result_pb2.FacingSource, message.facing, "FACING_SOURCE_"),
            energy=message.energies.final if ok else None,
            footprint=footprint_of(message.footprint) if ok else None,
            samples=samples_of(message.samples) if ok else None,
            evaluations=message.evaluations,
            stop_reason=word_of(result_pb2.StopReason, message.stop_reason, "STOP_REASON_"),
            foretold_wrong=optional(message, "foretold_wrong", lambda part: part.final),
            action=word_of(shot_pb2.TrackerAction, message.shot.action, "TRACKER_ACTION_")
            if tracked
            else None,
            frames_kept=message.shot.frames_kept if tracked else None,
            plan=Plan.of(message.plan, shot_plan)
            if message.HasField("plan")
            else None,
            message=message,
        )


class _Lights:
    """What results of several lights have in common."""

    lights: List[LightResult]

    @property
    def ok(self) -> bool:
        """Whether every light has its matrix, or its plan."""
        return all(light.ok for light in self.lights)

    def __getitem__(self, name: str) -> LightResult:
        for light in self.lights:
            if light.name == name:
                return light
        raise KeyError(name)

    def raise_for_status(self) -> None:
        """Raises the error of the first light that has no matrix, if there is one."""
        for light in self.lights:
            if not light.ok:
                raise error_of(light.message.status.code, _named(light))


@dataclasses.dataclass(frozen=True, eq=False)
class FitResult(_Lights):
    """One LightResult per light, in the order of the call; result["sun"] is that of one."""

    lights: List[LightResult]
    message: result_pb2.FitResult = dataclasses.field(repr=False)

    @classmethod
    def of(cls, message: result_pb2.FitResult) -> "FitResult":
        _warn(message.readback)
        return cls([LightResult.of(light) for light in message.lights], message)


@dataclasses.dataclass(frozen=True, eq=False)
class Evaluation:
    """How good one of the caller's matrices is. Figures are None when status is not ok."""

    light: str
    status: Status
    energy: Optional[float]  # as LightResult.energy
    footprint: Optional[Footprint]
    samples: Optional[Samples]
    num_behind: Optional[int]  # samples with w <= 0: outside the map, not in energy and footprint
    wrong_share: Optional[float]  # share of the image's pixels that will be wrong, foretold
    message: service_pb2.Evaluation = dataclasses.field(repr=False)

    @property
    def ok(self) -> bool:
        return self.status.ok

    @classmethod
    def of(cls, message: service_pb2.Evaluation) -> "Evaluation":
        status = status_of(message.status)
        ok = status.ok
        return cls(
            light=message.light,
            status=status,
            energy=message.energy if ok else None,
            footprint=footprint_of(message.footprint) if ok else None,
            samples=samples_of(message.samples) if ok else None,
            num_behind=message.num_behind if ok else None,
            wrong_share=message.wrong_share if ok else None,
            message=message,
        )


@dataclasses.dataclass(frozen=True, eq=False)
class EvaluateResult:
    """In the order of the matrices of the call."""

    evaluations: List[Evaluation]
    message: service_pb2.EvaluateResult = dataclasses.field(repr=False)

    @classmethod
    def of(cls, message: service_pb2.EvaluateResult) -> "EvaluateResult":
        _warn(message.readback)
        return cls([Evaluation.of(evaluation) for evaluation in message.evaluations], message)


@dataclasses.dataclass(frozen=True, eq=False)
class Allocation(_Lights):
    """LightResult.map_size is the size found, and (0, 0) where there is none."""

    lights: List[LightResult]
    texels: int  # of all maps together
    message: allocation_pb2.Allocation = dataclasses.field(repr=False)

    @property
    def map_sizes(self) -> Dict[str, Tuple[int, int]]:
        """By light: (width, height), texels."""
        return {light.name: light.map_size for light in self.lights}

    @classmethod
    def of(cls, message: allocation_pb2.Allocation) -> "Allocation":
        _warn(message.readback)
        return cls([LightResult.of(light) for light in message.lights], message.texels, message)


def status_of(message: result_pb2.Status) -> Status:
    return Status(Code.name_of(message.code), message.message)


def _warn(readback: result_pb2.ReadbackInfo) -> None:
    """In the name of whoever called for the result."""
    for text in readback.warnings:
        warnings.warn(text, LightfitWarning, stacklevel=4)


def _named(light: LightResult) -> str:
    name = f'light "{light.name}"'
    message = str(light.status)
    return message if name in message else f"{name}: {message}"


def samples_of(message: result_pb2.SampleCounts) -> Samples:
    return Samples(*(getattr(message, field.name) for field in dataclasses.fields(Samples)))
