"""A sequence of frames, whoever answers."""

from __future__ import annotations

import abc
from types import TracebackType
from typing import Any, Optional, Sequence, Type

from lightfit.cover import FineCover
from lightfit.errors import error_of
from lightfit.inputs import AnyCamera, Lights
from lightfit.pixels import Pixels
from lightfit.request import ReadbackParts, readback_parts, track_frame
from lightfit.result import FitResult
from lightfit.v1 import service_pb2, shot_pb2


class Track(abc.ABC):
    """A sequence of frames, from `track(...)` or `track_plan(...)`; a context manager. Not for two
    threads at once."""

    def __init__(self) -> None:
        #: What the tracker remembers after the latest frame: for `track(..., state=...)`.
        self.state: Sequence[shot_pb2.TrackedState] = ()

    def update(
        self,
        number: int,
        depth: Any,
        shadow: Any,
        camera: AnyCamera,
        lights: Lights,
        *,
        facing: Any = None,
        mapped: Any = None,
        cover: Optional[FineCover] = None,
        background: Optional[float] = None,
        source: str = "",
    ) -> FitResult:
        """The matrices, or plans, of the next frame.

        number: the caller's, comes back in result.message.shot.number.
        depth, shadow, camera, lights, facing, mapped, cover, background: as for `fit`, plans
            without cover. A light is known by its name, and forgotten when a frame is without it.

        LightResult.action says what became of the matrix of the frame before, PlanMap.action of
        each map of a plan. Raises LightfitError when the frame cannot be used; the tracker stays as
        it was, and the next frame may come.
        """
        parts = readback_parts(
            depth, shadow, camera, lights, source, facing, mapped, cover, background
        )
        return self.update_parts(number, parts)

    def update_parts(self, number: int, parts: ReadbackParts) -> FitResult:
        """`update` with what its arguments are made into."""
        answer = self._update(track_frame(number, parts), parts.pixels)
        if answer.status.code != 0:
            raise error_of(answer.status.code, answer.status.message, self._request_id())
        self.state = tuple(answer.result.shot.tracker_state)
        return FitResult.of(answer.result)

    @abc.abstractmethod
    def close(self) -> None:
        """Ends the sequence."""

    def __enter__(self) -> "Track":
        return self

    def __exit__(
        self,
        kind: Optional[Type[BaseException]],
        error: Optional[BaseException],
        trace: Optional[TracebackType],
    ) -> None:
        self.close()

    @abc.abstractmethod
    def _update(
        self, frame: service_pb2.TrackFrame, pixels: Pixels
    ) -> service_pb2.TrackResult: ...

    @abc.abstractmethod
    def _request_id(self) -> Optional[str]: ...
