"""SIGTERM: what was taken is answered, and clients that come later know to go elsewhere."""

import itertools
import signal
import threading
import time
from typing import Any, List, Tuple

import grpc
import numpy

import lightfit
from lightfit.channel import SERVICE
from serving import wait_until
from workload import (
    LONG,
    MAP,
    OK,
    UNAVAILABLE,
    Load,
    Readback,
    begin,
    connect,
    is_well,
    long_readback,
    small_readback,
    stub_of,
    track_requests,
    until_killed,
)

SERVING, NOT_SERVING = b"\x08\x01", b"\x08\x02"  # grpc.health.v1.HealthCheckResponse


class HealthWatch:
    """What grpc.health.v1.Health/Watch says, and when."""

    def __init__(self, address: str) -> None:
        self.changes: List[Tuple[float, bytes]] = []
        self._address = address
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def join(self) -> None:
        self._thread.join(timeout=60)
        assert not self._thread.is_alive()

    def _run(self) -> None:
        name = SERVICE.encode()
        with connect(self._address) as channel:
            watch = channel.unary_stream("/grpc.health.v1.Health/Watch")
            try:
                for answer in watch(b"\x0a" + bytes([len(name)]) + name):
                    self.changes.append((time.monotonic(), answer))
            except grpc.RpcError:
                pass  # the server has gone


def test_no_call_that_was_taken_is_lost(start: Any) -> None:
    server = start("--drain-delay-s", 0.5)
    watch = HealthWatch(server.address)
    loads = [Load(server.address, f"client {number}") for number in range(10)]
    wait_until(lambda: all(len(load.answers) >= 6 for load in loads), "clients are served")
    wait_until(lambda: [health for _, health in watch.changes] == [SERVING], "SERVING")
    assert server.stop() == 0
    watch.join()
    for load in loads:
        load.join()

    answers = {answer.request_id: answer for load in loads for answer in load.answers}
    codes = [answer.code for answer in answers.values()]
    print(f"{codes.count(OK)} answered, {codes.count(UNAVAILABLE)} refused")
    assert set(codes) == {OK, UNAVAILABLE}, [a for a in answers.values() if a.code is not OK]
    logged = {record["request_id"]: record["code"] for record in server.events("call")}
    for request_id, code in logged.items():
        assert answers[request_id].code.name == code, answers[request_id]
    for answer in answers.values():
        assert answer.code is UNAVAILABLE or logged[answer.request_id] == "OK"
    assert [health for _, health in watch.changes] == [SERVING, NOT_SERVING]
    first_refusal_s = min(load.end_s for load in loads)
    assert watch.changes[1][0] < first_refusal_s


def test_a_drain_has_its_limit(start: Any) -> None:
    server = start("--drain-limit-s", 0.5)
    with connect(server.address) as channel:
        call = begin(stub_of(channel), "FitStream", long_readback(), LONG, timeout_s=None)
        wait_until(lambda: server.metric("lightfit_workers_busy") == 1, "the search begins")
        assert server.stop() == 3
        assert call.code() is UNAVAILABLE, call.details()
    (stop,) = server.events("stop")
    assert stop["level"] == "warning" and stop["message"].endswith(": 1"), stop


def test_a_second_sigterm_ends_it_at_once(start: Any) -> None:
    server = start("--drain-limit-s", 1000)
    with connect(server.address) as channel:
        call = begin(stub_of(channel), "Fit", long_readback(), LONG, timeout_s=None)
        wait_until(lambda: server.metric("lightfit_workers_busy") == 1, "the search begins")
        server.process.terminate()
        wait_until(lambda: bool(server.events("drain")), "the drain begins")
        assert server.stop() == -signal.SIGTERM
        assert call.code() is UNAVAILABLE, call.details()


def frames() -> List[Readback]:
    """The shadows move."""
    depth, shadow, camera, lights = small_readback()
    return [(depth, numpy.roll(shadow, 3 * step, axis=1), camera, lights) for step in range(8)]


def test_a_track_that_is_drained_goes_on_elsewhere(start: Any) -> None:
    first, second = start(), start()
    with lightfit.Client(second.address) as client:
        with client.track(MAP, stability=0.5) as track:
            want = [track.update(number, *frame).message for number, frame in enumerate(frames())]

        requests = itertools.chain(track_requests(frames()[:4]), until_killed())
        with connect(first.address) as channel:
            stream = stub_of(channel).Track(requests)
            answers = [next(stream) for _ in range(4)]
            assert [answer.result for answer in answers] == want[:4]
            assert first.stop() == 0
            assert stream.code() is UNAVAILABLE, stream.details()
            assert "tracker_state" in stream.details()

        state = answers[-1].result.shot.tracker_state
        with client.track(MAP, stability=0.5, state=state) as track:
            for number in range(4, 8):
                assert track.update(number, *frames()[number]).message == want[number]
    assert is_well(second.address)
