"""Calls to load a server with, below the level of lightfit.Client: no retries, and a connection for
everyone who asks."""

from __future__ import annotations

import functools
import itertools
import threading
import time
from typing import Any, Dict, Iterator, List, NamedTuple, Optional, Sequence, Tuple

import grpc
import numpy

import lightfit
from lightfit.request import fit_request, readback_parts, track_frame, track_setup
from lightfit.v1 import service_pb2, service_pb2_grpc
from readbacks import large_readback

MAP = (256, 256)

OK = grpc.StatusCode.OK
UNAVAILABLE = grpc.StatusCode.UNAVAILABLE

Readback = Tuple[Any, Any, Any, Any]  # the first arguments of `lightfit.fit`

# Line search as published, every candidate sample by sample.
LONG = {
    "search": "rotation_line_search",
    "affine": "min_area_rectangle",
    "sample_by_sample": True,
    "line_search_rounds": 1000,
}


def connect(address: str) -> Any:
    """A channel with a connection of its own."""
    return grpc.insecure_channel(
        address, [("grpc.use_local_subchannel_pool", 1), ("grpc.enable_http_proxy", 0)]
    )


def stub_of(channel: Any) -> Any:
    return service_pb2_grpc.LightFitStub(channel)  # type: ignore[no-untyped-call]


@functools.lru_cache(maxsize=None)
def small_readback() -> Readback:
    """A fit of it takes some milliseconds."""
    return large_readback(96, 64)


@functools.lru_cache(maxsize=None)
def long_readback() -> Readback:
    """A fit of it with the options LONG takes many minutes, unless it is stopped."""
    depth, _, camera, _ = large_readback(1024, 768)
    x, y = numpy.arange(1024)[None, :], numpy.arange(768)[:, None]
    shadow = numpy.zeros(depth.shape, numpy.uint32)
    for bit in range(32):
        shadow |= ((x // (20 + bit) + y // 30) % 2).astype(numpy.uint32) << numpy.uint32(bit)
    lights = [lightfit.Light.sun(f"sun {bit}", (0.02 * bit - 0.3, 1, 0.3)) for bit in range(32)]
    return depth, shadow, camera, lights


def whole_request(readback: Readback, options: Optional[Dict[str, Any]] = None) -> Any:
    """For Fit."""
    parts = readback_parts(*readback)
    request = fit_request(parts, MAP, options, "vulkan", False)
    parts.pixels.fill(request.readback)
    return request


def stream_requests(readback: Readback, options: Optional[Dict[str, Any]] = None) -> Iterator[Any]:
    """For FitStream."""
    parts = readback_parts(*readback)
    request = fit_request(parts, MAP, options, "vulkan", False)
    yield service_pb2.FitStreamRequest(request=request)
    for chunk in parts.pixels.chunks():
        yield service_pb2.FitStreamRequest(pixels=chunk)


def track_requests(
    frames: Sequence[Readback], options: Optional[Dict[str, Any]] = None
) -> Iterator[Any]:
    """For Track: the setup, then frames numbered from 0, all of them in chunks."""
    yield service_pb2.TrackRequest(setup=track_setup(MAP, 0.5, None, options, "vulkan", ()))
    for number, frame in enumerate(frames):
        parts = readback_parts(*frame)
        yield service_pb2.TrackRequest(frame=track_frame(number, parts))
        for chunk in parts.pixels.chunks():
            yield service_pb2.TrackRequest(pixels=chunk)


def begin(
    stub: Any, method: str, readback: Readback, options: Dict[str, Any], timeout_s: Optional[float]
) -> Any:
    """A call under way of "Fit", "FitStream" or "Track"."""
    if method == "Fit":
        return stub.Fit.future(whole_request(readback, options), timeout=timeout_s)
    if method == "FitStream":
        return stub.FitStream.future(stream_requests(readback, options), timeout=timeout_s)
    open_end = itertools.chain(track_requests([readback], options), until_killed())
    return stub.Track(open_end, timeout=timeout_s)


def until_killed() -> Iterator[Any]:
    """No more messages, and no end either."""
    threading.Event().wait()
    yield


def is_well(address: str) -> bool:
    """Whether a fit over a new connection is answered, with all its lights."""
    with connect(address) as channel:
        result = stub_of(channel).Fit(whole_request(small_readback()), timeout=60)
    return len(result.lights) == 3 and all(light.status.code == 0 for light in result.lights)


class Answer(NamedTuple):
    request_id: str
    code: Any  # grpc.StatusCode
    details: str


class Load:
    """A client that calls Fit and FitStream in turn over its own connection, without retries, until
    it is told that the server is UNAVAILABLE, or to stop."""

    def __init__(self, address: str, name: str) -> None:
        self.answers: List[Answer] = []
        self.end_s = 0.0  # when it was over, time.monotonic()
        self._address, self._name = address, name
        self._is_stopping = False
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def stop(self) -> None:
        self._is_stopping = True

    def join(self) -> None:
        self._thread.join(timeout=60)
        assert not self._thread.is_alive(), f"client {self._name} hangs"

    def _run(self) -> None:
        with connect(self._address) as channel:
            stub = stub_of(channel)
            for number in itertools.count():
                request_id = f"{self._name}.{number}"
                headers = [("x-request-id", request_id)]
                try:
                    if number % 2 == 0:
                        stub.Fit(whole_request(small_readback()), timeout=60, metadata=headers)
                    else:
                        parts = stream_requests(small_readback())
                        stub.FitStream(parts, timeout=60, metadata=headers)
                    self.answers.append(Answer(request_id, OK, ""))
                except grpc.RpcError as error:
                    self.answers.append(Answer(request_id, error.code(), error.details()))
                if self._is_stopping or self.answers[-1].code is UNAVAILABLE:
                    self.end_s = time.monotonic()
                    return
