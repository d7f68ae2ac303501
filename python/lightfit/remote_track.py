"""A sequence of frames at a server: one stream, opened anew where it broke."""

from __future__ import annotations

import queue
import threading
from typing import Any, Callable, Iterator, Optional

import grpc

from lightfit.channel import Peer, error_of_call
from lightfit.errors import CancelledError, DeadlineError, UnavailableError
from lightfit.pixels import Pixels
from lightfit.retry import RetryPolicy, call_with_retries
from lightfit.tracks import Track
from lightfit.v1 import service_pb2

# Larger frames follow their header in chunks.
_CHUNKS_ABOVE_BYTES = 3 << 20

# How long the server has to end a stream that is done.
_END_WITHIN_S = 5.0


class _Stream:
    """One Track call. Requests go through a queue: gRPC takes them on a thread of its own."""

    def __init__(self, open_call: Callable[[Iterator[Any]], Any]) -> None:
        self._requests: "queue.SimpleQueue[Any]" = queue.SimpleQueue()  # None: no more
        self._call = open_call(iter(self._requests.get, None))

    def send(self, request: service_pb2.TrackRequest) -> None:
        self._requests.put(request)

    def receive(self, timeout_s: Optional[float]) -> Any:
        """The next answer; None at the stream's end. Raises grpc.RpcError, or TimeoutError."""
        expired = threading.Event()

        def expire() -> None:
            expired.set()
            self._call.cancel()

        timer = None if timeout_s is None else threading.Timer(timeout_s, expire)
        if timer is not None:
            timer.daemon = True
            timer.start()
        try:
            return next(self._call)
        except StopIteration:
            return None
        except grpc.RpcError:
            if expired.is_set():
                raise TimeoutError from None
            raise
        finally:
            if timer is not None:
                timer.cancel()

    def end(self) -> None:
        """Says that there are no more frames, and waits until the server has seen it."""
        self._requests.put(None)
        try:
            self.receive(_END_WITHIN_S)
        except (grpc.RpcError, TimeoutError):
            pass  # What was asked for has been answered.

    def drop(self) -> None:
        self._requests.put(None)
        self._call.cancel()


class RemoteTrack(Track):
    """open_call: begins the stream of requests that it is given. sleep: between attempts, seconds."""

    def __init__(
        self,
        open_call: Callable[[Iterator[Any]], Any],
        setup: service_pb2.TrackSetup,
        policy: RetryPolicy,
        timeout_s: Optional[float],
        sleep: Callable[[float], None],
        request_id: str,
        peer: Optional[Peer] = None,
    ) -> None:
        super().__init__()
        self._open_call = open_call
        self._setup = setup
        self._policy = policy
        self._timeout_s = timeout_s
        self._sleep = sleep
        self._id = request_id
        self._peer = peer
        self._stream: Optional[_Stream] = None
        self._is_closed = False

    def close(self) -> None:
        self._is_closed = True
        if self._stream is not None:
            self._stream.end()
            self._stream = None

    def _request_id(self) -> Optional[str]:
        return self._id

    def _update(self, frame: service_pb2.TrackFrame, pixels: Pixels) -> service_pb2.TrackResult:
        if self._is_closed:
            raise CancelledError("track: is closed, want a new one", request_id=self._id)
        return call_with_retries(
            lambda remaining_s: self._attempt(frame, pixels, remaining_s),
            self._policy,
            self._timeout_s,
            self._sleep,
        )

    def _attempt(
        self, frame: service_pb2.TrackFrame, pixels: Pixels, timeout_s: Optional[float]
    ) -> service_pb2.TrackResult:
        stream = self._opened()
        answer = None
        try:
            _send_frame(stream, frame, pixels)
            answer = stream.receive(timeout_s)
        except grpc.RpcError as error:
            raise error_of_call(error, self._id, self._peer) from None
        except TimeoutError:
            raise DeadlineError(
                f"track: frame {frame.number} was not done within {self._timeout_s} s",
                request_id=self._id,
            ) from None
        finally:
            if answer is None:
                stream.drop()
                self._stream = None
        if answer is None:
            raise UnavailableError("track: the server ended the stream", request_id=self._id)
        result: service_pb2.TrackResult = answer
        return result

    def _opened(self) -> _Stream:
        if self._stream is None:
            setup = service_pb2.TrackSetup()
            setup.CopyFrom(self._setup)
            del setup.state[:]
            setup.state.extend(self.state)
            self._stream = _Stream(self._open_call)
            self._stream.send(service_pb2.TrackRequest(setup=setup))
        return self._stream


def _send_frame(stream: _Stream, frame: service_pb2.TrackFrame, pixels: Pixels) -> None:
    if pixels.num_bytes > _CHUNKS_ABOVE_BYTES:
        stream.send(service_pb2.TrackRequest(frame=frame))
        for chunk in pixels.chunks():
            stream.send(service_pb2.TrackRequest(pixels=chunk))
        return
    whole = service_pb2.TrackFrame()
    whole.CopyFrom(frame)
    pixels.fill(whole.readback)
    stream.send(service_pb2.TrackRequest(frame=whole))
