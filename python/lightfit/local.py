"""Calls answered in this process, by the library itself, without a server."""

from __future__ import annotations

import contextlib
from typing import Any, Dict, Iterator, Optional, Tuple

from lightfit import _load
from lightfit.calls import Calls
from lightfit.errors import CancelledError, LightfitError
from lightfit.pixels import Pixels
from lightfit.tracks import Track
from lightfit.v1 import allocation_pb2, comparison_pb2, readback_pb2, result_pb2, service_pb2

_ANSWERS: Dict[str, Any] = {
    "FitSummary": result_pb2.FitResult,
    "Evaluate": service_pb2.EvaluateResult,
    "Allocate": allocation_pb2.Allocation,
    "Summarize": service_pb2.SummarizeResult,
    "Compare": comparison_pb2.Comparison,
}


class Local(Calls):
    """Searches let other threads run, and end within some ten milliseconds of Ctrl-C."""

    def _fit(
        self,
        request: service_pb2.FitRequest,
        pixels: Pixels,
        timeout_s: Optional[float],
        request_id: Optional[str],
    ) -> result_pb2.FitResult:
        native = _load.native()
        _put_cover(pixels, request.readback)
        with _named(request_id):
            answer = native.fit(request.SerializeToString(), *_arrays(pixels), timeout_s)
        result = result_pb2.FitResult()
        result.ParseFromString(answer)
        return result

    def _call(
        self, method: str, request: Any, timeout_s: Optional[float], request_id: Optional[str]
    ) -> Any:
        native = _load.native()
        with _named(request_id):
            answer = native.call(method, request.SerializeToString(), timeout_s)
        return _ANSWERS[method].FromString(answer)

    def _track(
        self,
        setup: service_pb2.TrackSetup,
        timeout_s: Optional[float],
        request_id: Optional[str],
    ) -> Track:
        return LocalTrack(setup, timeout_s, request_id)


class LocalTrack(Track):
    """What the tracker remembers lives in the compiled part."""

    def __init__(
        self,
        setup: service_pb2.TrackSetup,
        timeout_s: Optional[float],
        request_id: Optional[str],
    ) -> None:
        super().__init__()
        self._timeout_s = timeout_s
        self._id = request_id
        with _named(request_id):
            self._session = _load.native().Track(setup.SerializeToString())

    def close(self) -> None:
        self._session = None

    def _request_id(self) -> Optional[str]:
        return self._id

    def _update(self, frame: service_pb2.TrackFrame, pixels: Pixels) -> service_pb2.TrackResult:
        if self._session is None:
            raise CancelledError("track: is closed, want a new one", request_id=self._id)
        _put_cover(pixels, frame.readback)
        with _named(self._id):
            answer = self._session.update(
                frame.SerializeToString(), *_arrays(pixels), self._timeout_s
            )
        result = service_pb2.TrackResult()
        result.ParseFromString(answer)
        return result


def _put_cover(pixels: Pixels, readback: readback_pb2.Readback) -> None:
    """The one part that goes to the compiled part in the message."""
    if pixels.cover is not None:
        pixels.cover.fill(readback)


def _arrays(pixels: Pixels) -> Tuple[Any, Any, Any, Any]:
    """Depth, shadow, facing and mapped as the compiled part takes them."""
    return (*pixels.as_floats_and_bits(), *pixels.optional_bits())


@contextlib.contextmanager
def _named(request_id: Optional[str]) -> Iterator[None]:
    """Errors from within say which call they belong to."""
    try:
        yield
    except LightfitError as error:
        error.request_id = request_id
        raise
