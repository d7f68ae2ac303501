"""Several maps for one light, and which of them a receiver asks."""

from __future__ import annotations

import dataclasses
from typing import Any, List, Optional, Tuple

import numpy
from numpy.typing import ArrayLike, NDArray

from lightfit.errors import InvalidArgumentError
from lightfit.messages import Footprint, Matrix, footprint_of, lower_word, matrix_of, word_of
from lightfit.v1 import matrix_pb2, result_pb2, shot_pb2


@dataclasses.dataclass(frozen=True, eq=False)
class PlanMap:
    """One of the maps."""

    index: int  # in Plan.maps: the layer of an array of textures
    map_size: Tuple[int, int]  # (width, height), texels
    map_from_world: Optional[Matrix]  # (4, 4), as LightResult.map_from_world
    clip_from_world: Optional[Matrix]  # (4, 4), in the convention that was asked for
    coarseness: float  # how far its texels reach, up to what all maps have in common; > 0
    energy: float  # over the samples that ask this map
    footprint: Footprint
    samples: int  # how many those are

    # In a track: as LightResult.action and frames_kept, of this map.
    action: Optional[str]
    frames_kept: Optional[int]

    message: result_pb2.PlanMap = dataclasses.field(repr=False)

    @classmethod
    def of(
        cls, message: result_pb2.PlanMap, shot: Optional[shot_pb2.ShotMap] = None
    ) -> "PlanMap":
        return cls(
            index=message.index,
            map_size=(message.map.width, message.map.height),
            map_from_world=matrix_of(message.map_from_world),
            clip_from_world=matrix_of(message.clip_from_world),
            coarseness=message.coarseness,
            energy=message.energy,
            footprint=footprint_of(message.footprint),
            samples=message.samples,
            action=word_of(shot_pb2.TrackerAction, shot.action, "TRACKER_ACTION_")
            if shot is not None
            else None,
            frames_kept=shot.frames_kept if shot is not None else None,
            message=message,
        )


@dataclasses.dataclass(frozen=True, eq=False)
class Plan:
    """The maps of one light: one or more."""

    maps: List[PlanMap]
    border: Optional[str]  # "lit" or "dark": what a receiver finds that no map holds
    guard_texels: float  # half the width of the filter that the plan was made for
    texels: int  # of all maps

    # In a track: whether number and sizes of maps may be others than in the frame before.
    is_new: Optional[bool]

    message: result_pb2.Plan = dataclasses.field(repr=False)

    def look_up(self, points: ArrayLike) -> Tuple[NDArray[numpy.int32], NDArray[numpy.float64]]:
        """Which map a receiver asks, and where: the densest of those that hold it.

        points: (..., 3), world.
        Returns the index into `maps`, (...), -1 where none holds the point; and the place in that
        map, (..., 2), u right and v down in texels, NaN where there is none.
        """
        points = numpy.asarray(points, dtype=numpy.float64)
        if points.ndim < 1 or points.shape[-1] != 3:
            raise InvalidArgumentError(f"points: has shape {points.shape}, want (..., 3)")
        asked = numpy.full(points.shape[:-1], -1, dtype=numpy.int32)
        texels = numpy.full((*points.shape[:-1], 2), numpy.nan)
        least = numpy.full(points.shape[:-1], numpy.inf)
        guard = self.guard_texels
        for index, plan_map in enumerate(self.maps):
            if plan_map.map_from_world is None:
                continue
            matrix = plan_map.map_from_world
            u_w, v_w, w = (points @ matrix[row, :3] + matrix[row, 3] for row in (0, 1, 3))
            with numpy.errstate(divide="ignore", invalid="ignore"):
                u, v = u_w / w, v_w / w
            width, height = plan_map.map_size
            holds = (w > 0) & (u >= guard) & (u < width - guard)
            holds &= (v >= guard) & (v < height - guard)
            q = plan_map.coarseness * w
            better = holds & (q < least)
            asked[better] = index
            least[better] = q[better]
            texels[better] = numpy.stack([u, v], axis=-1)[better]
        return asked, texels

    @classmethod
    def of(cls, message: result_pb2.Plan, shot: Optional[shot_pb2.ShotPlan] = None) -> "Plan":
        shots: List[Any] = [None] * len(message.maps) if shot is None else list(shot.maps)
        return cls(
            maps=[PlanMap.of(part, shot_map) for part, shot_map in zip(message.maps, shots)],
            border=lower_word(matrix_pb2.Border, message.border, "BORDER_"),
            guard_texels=message.guard_texels,
            texels=message.texels,
            is_new=shot.is_new if shot is not None else None,
            message=message,
        )
