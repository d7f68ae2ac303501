"""Calls to a server, `lightfit serve`."""

from __future__ import annotations

import secrets
from types import TracebackType
from typing import Any, Callable, Iterator, List, Optional, Tuple, Type

import grpc

from lightfit.calls import Calls
from lightfit.channel import SERVICE, TlsOptions, error_of_call, open_channel, pause
from lightfit.errors import InvalidArgumentError
from lightfit.pixels import Pixels
from lightfit.remote_track import RemoteTrack
from lightfit.retry import RetryPolicy, call_with_retries
from lightfit.tracks import Track
from lightfit.v1 import result_pb2, service_pb2, service_pb2_grpc

# Larger read-backs go in chunks.
STREAM_ABOVE_BYTES = 8 << 20

# grpc.health.v1.HealthCheckResponse.ServingStatus
_HEALTH = ("UNKNOWN", "SERVING", "NOT_SERVING", "SERVICE_UNKNOWN")


class Client(Calls):
    """A connection to one server or to many; a context manager. May be used by many threads.

    address: "127.0.0.1:50071", "unix:/path"; "10.0.0.1:50071,10.0.0.2:50071" or "dns:///NAME:PORT"
        for many, over which calls are spread.
    tls: TlsOptions(ca=..., cert=..., key=...); None: without encryption.
    timeout_s: of calls that are not told another, in all; None: no limit.
    retries: how often a call is tried again when the server is busy or away, see RetryPolicy.
    round_robin: whether to spread calls over all servers that say they serve; None: when there are
        many.

    Proxies of the environment (http_proxy and the like) are for other machines: this one is asked
    directly, and so are those that no_proxy names.

    Nothing is sent before the first call. The read-backs of EXR files are read here and need the
    compiled part; arrays do not.
    """

    def __init__(
        self,
        address: str = "127.0.0.1:50071",
        *,
        tls: Optional[TlsOptions] = None,
        timeout_s: Optional[float] = 60.0,
        retries: int = RetryPolicy.retries,
        round_robin: Optional[bool] = None,
    ) -> None:
        self._channel, self._peer = open_channel(address, tls, round_robin)
        self._stub = service_pb2_grpc.LightFitStub(self._channel)  # type: ignore[no-untyped-call]
        self._timeout_s = timeout_s
        self._policy = RetryPolicy(retries)

    def health(self, *, timeout_s: float = 5.0) -> str:
        """"SERVING"; "NOT_SERVING" when the server is about to go. Raises UnavailableError when
        there is none. Not tried again."""
        check = self._channel.unary_unary("/grpc.health.v1.Health/Check")
        name = SERVICE.encode()
        try:
            answer = check(b"\x0a" + bytes([len(name)]) + name, timeout=timeout_s)
        except grpc.RpcError as error:
            if error.code() is grpc.StatusCode.NOT_FOUND:
                return "SERVICE_UNKNOWN"
            raise error_of_call(error, None, self._peer) from None
        # One field of one byte, absent when 0.
        return _HEALTH[answer[1]] if len(answer) == 2 and answer[1] < len(_HEALTH) else _HEALTH[0]

    def close(self) -> None:
        """Ends the connection; calls under way are cancelled."""
        self._channel.close()

    def __enter__(self) -> "Client":
        return self

    def __exit__(
        self,
        kind: Optional[Type[BaseException]],
        error: Optional[BaseException],
        trace: Optional[TracebackType],
    ) -> None:
        self.close()

    def _fit(
        self,
        request: service_pb2.FitRequest,
        pixels: Pixels,
        timeout_s: Optional[float],
        request_id: Optional[str],
    ) -> result_pb2.FitResult:
        call: Any = self._stub.Fit
        make_request: Callable[[], Any] = lambda: request
        if pixels.num_bytes > STREAM_ABOVE_BYTES:
            call = self._stub.FitStream
            make_request = lambda: _parts(request, pixels)
        else:
            pixels.fill(request.readback)
        result: result_pb2.FitResult = self._run(call, make_request, timeout_s, request_id)
        return result

    def _call(
        self, method: str, request: Any, timeout_s: Optional[float], request_id: Optional[str]
    ) -> Any:
        return self._run(getattr(self._stub, method), lambda: request, timeout_s, request_id)

    def _track(
        self,
        setup: service_pb2.TrackSetup,
        timeout_s: Optional[float],
        request_id: Optional[str],
    ) -> Track:
        request_id, metadata = _request_id(request_id)
        return RemoteTrack(
            lambda requests: self._stub.Track(requests, metadata=metadata),
            setup,
            self._policy,
            self._timeout_s if timeout_s is None else timeout_s,
            self._pause,
            request_id,
            self._peer,
        )

    def _run(
        self,
        call: Any,
        make_request: Callable[[], Any],
        timeout_s: Optional[float],
        request_id: Optional[str],
    ) -> Any:
        """make_request: is called once per attempt."""
        request_id, metadata = _request_id(request_id)

        def attempt(remaining_s: Optional[float]) -> Any:
            running = call.future(make_request(), timeout=remaining_s, metadata=metadata)
            try:
                return running.result()
            except grpc.RpcError as error:
                raise error_of_call(error, request_id, self._peer) from None
            except grpc.FutureCancelledError:
                raise error_of_call(running, request_id, self._peer) from None
            finally:
                running.cancel()  # does nothing when it is done; stops the search on Ctrl-C

        return call_with_retries(
            attempt,
            self._policy,
            self._timeout_s if timeout_s is None else timeout_s,
            self._pause,
        )

    def _pause(self, wait_s: float) -> None:
        pause(self._channel, wait_s)


def _request_id(request_id: Optional[str]) -> Tuple[str, List[Tuple[str, str]]]:
    """The call's name, and the header that says so."""
    if request_id is None:
        request_id = secrets.token_hex(8)
    elif not (request_id.isascii() and request_id.isprintable() and 1 <= len(request_id) <= 128):
        raise InvalidArgumentError(
            f"request_id = {request_id!r}, want 1 to 128 printable ASCII characters"
        )
    return request_id, [("x-request-id", request_id)]


def _parts(
    request: service_pb2.FitRequest, pixels: Pixels
) -> Iterator[service_pb2.FitStreamRequest]:
    yield service_pb2.FitStreamRequest(request=request)
    for chunk in pixels.chunks():
        yield service_pb2.FitStreamRequest(pixels=chunk)
