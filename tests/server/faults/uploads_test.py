"""Clients that send slowly, or nothing any more."""

import itertools
import threading
import time
from typing import Any, Iterator

import grpc

from serving import wait_until
from workload import (
    OK,
    Load,
    connect,
    is_well,
    long_readback,
    stream_requests,
    stub_of,
    track_requests,
)

NUM_DRIBBLERS = 20
TIMEOUT_S = 3


def dribble(requests: Iterator[Any], ended: threading.Event) -> Iterator[Any]:
    """The first messages, then a byte now and then."""
    first, second, chunk = itertools.islice(requests, 3)
    yield from (first, second)
    pixel = type(chunk)()
    pixel.pixels.depth = bytes(4)
    while not ended.is_set():
        yield pixel
        time.sleep(0.1)


def test_dribblers_are_ended_and_hold_nobody_up(start: Any) -> None:
    server = start("--upload-timeout-s", TIMEOUT_S)
    ended = threading.Event()
    channels = [connect(server.address) for _ in range(NUM_DRIBBLERS)]
    calls = [
        stub_of(channel).FitStream.future(dribble(stream_requests(long_readback()), ended))
        for channel in channels
    ]
    wait_until(
        lambda: server.metric("lightfit_calls_in_flight") == NUM_DRIBBLERS, "all of them are there"
    )
    loads = [Load(server.address, f"client {number}") for number in range(4)]
    for call in calls:
        assert call.code() is grpc.StatusCode.DEADLINE_EXCEEDED, call.details()
        assert "send it faster" in call.details()
    ended.set()
    for load in loads:
        load.stop()
        load.join()
    print(f"{sum(len(load.answers) for load in loads)} calls beside {NUM_DRIBBLERS} dribblers")
    for load in loads:
        assert load.answers  # how many depends on the machine
        assert {answer.code for answer in load.answers} == {OK}
    server.wait_until_idle()
    for channel in channels:
        channel.close()
    assert is_well(server.address)


def test_a_track_that_stalls_within_a_frame_is_ended(start: Any) -> None:
    server = start("--upload-timeout-s", 0.5)
    ended = threading.Event()
    with connect(server.address) as channel:
        requests = track_requests([long_readback()])
        setup = next(requests)
        stream = stub_of(channel).Track(itertools.chain([setup], dribble(requests, ended)))
        assert stream.code() is grpc.StatusCode.DEADLINE_EXCEEDED, stream.details()
        ended.set()
    server.wait_until_idle()
    assert is_well(server.address)


def test_a_track_may_wait_between_frames(start: Any) -> None:
    server = start("--upload-timeout-s", 0.2)
    with connect(server.address) as channel:
        go_on = threading.Event()

        def requests() -> Iterator[Any]:
            setup, *frame = track_requests([long_readback()], {"search": "focused"})
            yield from (setup, *frame)
            go_on.wait()
            yield from frame

        stream = stub_of(channel).Track(requests())
        assert next(stream).status.code == 0
        time.sleep(1)
        go_on.set()
        assert next(stream).status.code == 0
        stream.cancel()
    server.wait_until_idle()
