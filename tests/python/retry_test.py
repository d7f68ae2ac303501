"""Retries: the policy by itself, and the client against gRPC servers that fail in chosen ways."""

import concurrent.futures
import contextlib
import time
from typing import Any, Callable, Iterator, List, Optional, Tuple

import grpc
import numpy
import pytest

import lightfit
from lightfit.channel import TlsOptions, target_of
from lightfit.errors import LightfitError, error_of
from lightfit.retry import RetryPolicy, call_with_retries
from lightfit.v1 import result_pb2, service_pb2, service_pb2_grpc

BUSY = grpc.StatusCode.RESOURCE_EXHAUSTED
AWAY = grpc.StatusCode.UNAVAILABLE
PUSHBACK = ("grpc-retry-pushback-ms", "1")


class Flaky(service_pb2_grpc.LightFitServicer):  # type: ignore[misc]
    """Fails with these statuses, one per call, and answers from then on."""

    def __init__(self, failures: List[Tuple[Any, Tuple[Tuple[str, str], ...]]]) -> None:
        self.failures = failures
        self.request_ids: List[str] = []
        self.states: List[int] = []

    def _begin(self, context: Any) -> None:
        self.request_ids.append(dict(context.invocation_metadata())["x-request-id"])
        if self.failures:
            code, trailer = self.failures.pop(0)
            context.set_trailing_metadata(trailer)
            context.abort(code, "not\nnow")

    def Fit(self, request: Any, context: Any) -> Any:
        self._begin(context)
        return result_pb2.FitResult(lights=[{"name": light.name} for light in request.lights])

    def FitStream(self, requests: Any, context: Any) -> Any:
        first = next(requests).request
        num_bytes = sum(
            len(part.pixels.depth) + len(part.pixels.shadow_bits) for part in requests
        )
        self._begin(context)
        result = result_pb2.FitResult(lights=[{"name": light.name} for light in first.lights])
        result.lights[0].evaluations = num_bytes
        return result

    def Track(self, requests: Any, context: Any) -> Any:
        """Breaks after every second frame; the state is the number of frames so far."""
        setup = next(requests).setup
        num_frames = setup.state[0].frames_kept if setup.state else 0
        self.states.append(num_frames)
        for index, request in enumerate(requests):
            if index == 2:
                context.abort(AWAY, "draining")
            num_frames += 1
            answer = service_pb2.TrackResult(number=request.frame.number)
            answer.result.lights.add(name="sun")
            answer.result.shot.tracker_state.add(light="sun", frames_kept=num_frames)
            yield answer


@contextlib.contextmanager
def serving(flaky: Flaky) -> Iterator[str]:
    server = grpc.server(concurrent.futures.ThreadPoolExecutor(4))
    service_pb2_grpc.add_LightFitServicer_to_server(flaky, server)
    port = server.add_insecure_port("127.0.0.1:0")
    server.start()
    yield f"127.0.0.1:{port}"
    server.stop(None).wait()


CAMERA = lightfit.Camera.from_matrices(numpy.eye(4), numpy.eye(4), clip="vulkan")
SUN = [lightfit.Light.sun("sun", (0, 0, -1))]


def arguments(side: int) -> Tuple[Any, ...]:
    return (
        numpy.ones((side, side), numpy.float32),
        numpy.zeros((side, side), numpy.uint32),
        CAMERA,
        SUN,
    )


def fit(client: Any, side: int = 4, **more: Any) -> lightfit.FitResult:
    result: lightfit.FitResult = client.fit(*arguments(side), (8, 8), **more)
    return result


def test_waits_double_and_end() -> None:
    policy = RetryPolicy(retries=4, first_wait_s=1.0, longest_wait_s=3.0)
    for num_failed, most in ((1, 1.0), (2, 2.0), (3, 3.0), (4, 3.0)):
        wait = policy.wait_s(num_failed, lightfit.UnavailableError("away"))
        assert wait is not None and most / 2 <= wait <= most
    assert policy.wait_s(5, lightfit.UnavailableError("away")) is None


@pytest.mark.parametrize("code", [1, 3, 4, 8, 9, 13])
def test_what_trying_again_does_not_mend_is_not_tried_again(code: int) -> None:
    assert RetryPolicy().wait_s(1, error_of(code, "no")) is None


def test_the_server_says_how_long_to_wait() -> None:
    error = lightfit.BusyError("full")
    error.retry_after_s = 7.0
    wait = RetryPolicy(first_wait_s=0.1).wait_s(1, error)
    assert wait is not None and 7.05 <= wait <= 7.1
    error.retry_after_s = -1.0
    assert RetryPolicy().wait_s(1, error) is None


def test_waits_keep_within_the_time_limit() -> None:
    waits: List[float] = []
    attempts: List[Optional[float]] = []

    def attempt(remaining_s: Optional[float]) -> None:
        attempts.append(remaining_s)
        error = lightfit.BusyError("full")
        error.retry_after_s = 3600.0
        raise error

    with pytest.raises(lightfit.BusyError):
        call_with_retries(attempt, RetryPolicy(), 60.0, waits.append)
    assert len(attempts) == 1 and waits == []
    with pytest.raises(lightfit.BusyError):
        call_with_retries(attempt, RetryPolicy(retries=2), None, waits.append)
    assert attempts[1:] == [None] * 3 and len(waits) == 2


def test_a_busy_server_is_asked_again_under_the_same_name() -> None:
    flaky = Flaky([(BUSY, (PUSHBACK,)), (AWAY, ()), (BUSY, (PUSHBACK,))])
    with serving(flaky) as address, lightfit.Client(address) as client:
        assert [light.name for light in fit(client, request_id="frame 1").lights] == ["sun"]
    assert flaky.request_ids == ["frame 1"] * 4


def test_a_request_that_is_too_large_is_not_sent_again() -> None:
    flaky = Flaky([(BUSY, ())])
    with serving(flaky) as address, lightfit.Client(address) as client:
        with pytest.raises(lightfit.TooLargeError, match="^not now ") as caught:
            fit(client)
    assert caught.value.request_id == flaky.request_ids[0] and len(flaky.request_ids) == 1
    assert len(flaky.request_ids[0]) == 16


def test_cancelled_calls_are_not_sent_again() -> None:
    flaky = Flaky([(grpc.StatusCode.CANCELLED, ())])
    with serving(flaky) as address, lightfit.Client(address) as client:
        with pytest.raises(lightfit.CancelledError):
            fit(client)
    assert len(flaky.request_ids) == 1


def test_retries_come_to_an_end() -> None:
    flaky = Flaky([(BUSY, (PUSHBACK,))] * 9)
    with serving(flaky) as address, lightfit.Client(address, retries=2) as client:
        with pytest.raises(lightfit.BusyError) as caught:
            fit(client)
    assert caught.value.code == "RESOURCE_EXHAUSTED" and caught.value.retry_after_s == 0.001
    assert len(flaky.request_ids) == 3


def test_large_readbacks_are_streamed_and_streamed_again() -> None:
    flaky = Flaky([(AWAY, ())])
    with serving(flaky) as address, lightfit.Client(address) as client:
        assert fit(client, 1200).lights[0].evaluations == 1200 * 1200 * 8
    assert len(flaky.request_ids) == 2


def test_a_track_goes_on_where_it_broke() -> None:
    flaky = Flaky([])
    with serving(flaky) as address, lightfit.Client(address) as client:
        with client.track((8, 8)) as track:
            for number in range(5):
                track.update(number, *arguments(4))
            assert track.state[0].frames_kept == 5
        with pytest.raises(lightfit.CancelledError, match="closed"):
            track.update(5, *arguments(4))
    assert flaky.states == [0, 2, 4]


def test_no_server_is_said_so() -> None:
    with lightfit.Client("127.0.0.1:1", retries=1) as client:
        with pytest.raises(lightfit.UnavailableError, match="refused"):
            fit(client)
        with pytest.raises(lightfit.UnavailableError):
            client.health()


class Slow(Flaky):
    def Fit(self, request: Any, context: Any) -> Any:
        stopped: "concurrent.futures.Future[None]" = concurrent.futures.Future()
        context.add_callback(lambda: stopped.set_result(None))
        stopped.result(timeout=60)

    def Track(self, requests: Any, context: Any) -> Any:
        next(requests)
        self.Fit(None, context)
        yield service_pb2.TrackResult()


def test_deadlines_are_kept() -> None:
    with serving(Slow([])) as address, lightfit.Client(address, timeout_s=0.2) as client:
        with pytest.raises(TimeoutError) as caught:
            fit(client)
        assert isinstance(caught.value, lightfit.DeadlineError)
        with client.track((8, 8)) as track:
            with pytest.raises(lightfit.DeadlineError, match="frame 3 was not done within 0.2 s"):
                track.update(3, *arguments(4))


@pytest.mark.parametrize(
    "address, target, is_many",
    [
        ("127.0.0.1:5", "127.0.0.1:5", False),
        ("localhost:5", "localhost:5", False),
        ("unix:/tmp/s", "unix:/tmp/s", False),
        ("dns:///farm:5", "dns:///farm:5", True),
        ("10.0.0.1:5, 10.0.0.2:6", "ipv4:10.0.0.1:5,10.0.0.2:6", True),
        ("[::1]:5,[::2]:6", "ipv6:[::1]:5,[::2]:6", True),
        ("ipv4:10.0.0.1:5,10.0.0.2:6", "ipv4:10.0.0.1:5,10.0.0.2:6", True),
    ],
)
def test_addresses_name_one_server_or_many(address: str, target: str, is_many: bool) -> None:
    assert target_of(address) == (target, is_many)


@pytest.mark.parametrize(
    "address, words",
    [
        ("", "address = ''"),
        ("localhost", '"localhost" has no port, want HOST:PORT'),
        ("localhost:99999", "has no port"),
        ("a:1,b:2", "several servers are named by their numbers"),
        ("10.0.0.1:1,[::1]:2", "all IPv4 or all IPv6"),
    ],
)
def test_addresses_that_are_none_are_refused(address: str, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        lightfit.Client(address)


def test_calls_are_spread_over_servers() -> None:
    one, two = Flaky([]), Flaky([])
    with serving(one) as first, serving(two) as second:
        with lightfit.Client(f"{first},{second}") as client:
            until = time.monotonic() + 20
            while not (one.request_ids and two.request_ids) and time.monotonic() < until:
                fit(client)
    assert one.request_ids and two.request_ids


def test_files_of_keys_that_are_absent_are_said_so() -> None:
    with pytest.raises(ValueError, match="tls: ca: absent.pem: No such file"):
        lightfit.Client(tls=TlsOptions(ca="absent.pem"))
    with pytest.raises(ValueError, match="only one of cert and key"):
        lightfit.Client(tls=TlsOptions(cert="cert.pem"))


@pytest.mark.parametrize("request_id", ["", "a\nb", "ü", "x" * 129])
def test_request_ids_are_printable(request_id: str) -> None:
    with lightfit.Client() as client, pytest.raises(ValueError, match="request_id"):
        fit(client, request_id=request_id)
