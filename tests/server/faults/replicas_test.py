"""Servers that die and come back, alone or one of several: clients with retries do not notice."""

import threading
import time
from typing import Any, List

import numpy
import pytest

import lightfit
from serving import wait_until
from workload import MAP, is_well, small_readback

NUM_CLIENTS = 8


class Caller:
    """Calls Fit with the retries of lightfit.Client, again and again; counts the answers, and keeps
    what was raised."""

    def __init__(self, client: lightfit.Client, want: Any) -> None:
        self.num_answers = 0
        self.errors: List[Exception] = []
        self._client, self._want = client, want
        self._is_stopping = False
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def stop(self) -> None:
        self._is_stopping = True
        self._thread.join(timeout=60)
        assert not self._thread.is_alive()

    def _run(self) -> None:
        while not self._is_stopping:
            try:
                result = self._client.fit(*small_readback(), MAP)
                assert result.message == self._want
                self.num_answers += 1
            except Exception as error:  # whatever it is, the test shows it
                self.errors.append(error)


class Callers:
    """Some of them; a context manager."""

    def __init__(self, address: str) -> None:
        self._client = lightfit.Client(address, retries=12)  # servers start slowly under sanitizers
        want = self._client.fit(*small_readback(), MAP).message
        self._callers = [Caller(self._client, want) for _ in range(NUM_CLIENTS)]

    def __enter__(self) -> "Callers":
        return self

    def __exit__(self, *_: Any) -> None:
        for caller in self._callers:
            caller.stop()
        self._client.close()

    def go_on(self) -> None:
        """Until each of them has had answers again."""
        before = [caller.num_answers for caller in self._callers]
        wait_until(
            lambda: all(c.num_answers >= n + 3 for c, n in zip(self._callers, before)),
            f"answers; {self.errors()}",
        )

    def errors(self) -> List[Exception]:
        return [error for caller in self._callers for error in caller.errors]

    def num_answers(self) -> int:
        return sum(caller.num_answers for caller in self._callers)


def test_clients_recover_from_a_server_that_is_killed(start: Any) -> None:
    server = start()
    with Callers(server.address) as callers:
        for pause_s in (0.0, 0.5):
            callers.go_on()
            server.kill()
            time.sleep(pause_s)
            server = start(listen=server.address)
            callers.go_on()
    print(f"{callers.num_answers()} answers")
    assert callers.errors() == []


def test_calls_go_on_while_replicas_come_and_go(start: Any) -> None:
    first, second = start("--drain-delay-s", 0.3), start("--drain-delay-s", 0.3)
    with Callers(f"{first.address},{second.address}") as callers:
        callers.go_on()
        for server in (first, second):  # both have a share of the calls
            wait_until(lambda: len(server.events("call")) >= 10, "the calls are spread")
        assert first.stop() == 0
        callers.go_on()
        first = start(listen=first.address)
        wait_until(lambda: len(first.events("call")) >= 10, "it is back in its share")
        second.kill()
        callers.go_on()
        assert start(listen=second.address)
        callers.go_on()
    print(f"{callers.num_answers()} answers")
    assert callers.errors() == []


@pytest.mark.parametrize("how", ["drain", "kill"])
def test_a_track_moves_to_another_replica(start: Any, how: str) -> None:
    servers = [start(), start()]
    depth, shadow, camera, lights = small_readback()
    frames = [(depth, numpy.roll(shadow, 3 * step, axis=1), camera, lights) for step in range(6)]
    with lightfit.Client(servers[0].address) as client, client.track(MAP) as track:
        want = [track.update(number, *frame).message for number, frame in enumerate(frames)]
    both = ",".join(server.address for server in servers)
    with lightfit.Client(both) as client, client.track(MAP) as track:
        for number, frame in enumerate(frames):
            assert track.update(number, *frame).message == want[number]
            if number == 2:
                in_flight = [server.metric("lightfit_calls_in_flight") for server in servers]
                assert sorted(in_flight) == [0, 1]
                busy = servers[in_flight.index(1)]
                if how == "drain":
                    assert busy.stop() == 0
                else:
                    busy.kill()
    (other,) = (server for server in servers if server is not busy)
    assert is_well(other.address)
    wait_until(lambda: len(other.events("call")) >= 2, "the track's line in its log")
