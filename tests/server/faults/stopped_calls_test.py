"""Calls whose clients give up, or die: the server stops working for them and forgets them."""

import pathlib
import subprocess
import sys
from typing import Any, Dict

import grpc
import pytest

from serving import Server, wait_until
from workload import LONG, begin, connect, is_well, long_readback, stub_of

METHODS = ("Fit", "FitStream", "Track")
IN_TIME = ("--drain-limit-s", 20)


def the_call(server: Server) -> Dict[str, Any]:
    """What the log says of the only one."""
    wait_until(lambda: len(server.events("call")) == 1, "a line in the log")
    return server.events("call")[0]


@pytest.mark.parametrize("method", METHODS)
def test_a_deadline_stops_the_search(start: Any, method: str) -> None:
    server = start(*IN_TIME)
    with connect(server.address) as channel:
        call = begin(stub_of(channel), method, long_readback(), LONG, timeout_s=2)
        assert call.code() is grpc.StatusCode.DEADLINE_EXCEEDED, call.details()
        server.wait_until_idle()
    record = the_call(server)
    assert record["solve_ms"] > 0 and record["code"] != "OK", record
    assert is_well(server.address)


@pytest.mark.parametrize("method", METHODS)
def test_a_cancelled_call_stops_its_search(start: Any, method: str) -> None:
    server = start(*IN_TIME)
    with connect(server.address) as channel:
        call = begin(stub_of(channel), method, long_readback(), LONG, timeout_s=None)
        wait_until(lambda: server.metric("lightfit_workers_busy") == 1, "the search begins")
        assert server.metric("lightfit_calls_in_flight", f'method="{method}"') == 1
        assert server.metric("lightfit_readback_memory_bytes") >= 1024 * 768 * 8
        call.cancel()
        assert call.code() is grpc.StatusCode.CANCELLED, call.details()
        server.wait_until_idle()
    record = the_call(server)
    assert record["solve_ms"] > 0 and record["code"] == "CANCELLED", record
    assert is_well(server.address)


@pytest.mark.parametrize(
    "method, share",
    [
        ("Fit", "all"),
        ("FitStream", "half"),
        ("FitStream", "all"),
        ("Track", "half"),
        ("Track", "all"),
    ],
)
def test_a_killed_client_leaves_nothing_behind(start: Any, method: str, share: str) -> None:
    server = start(*IN_TIME)
    num_files = server.num_files()
    doomed = pathlib.Path(__file__).with_name("doomed_client.py")
    process = subprocess.Popen([sys.executable, str(doomed), server.address, method, share])
    try:
        if share == "all":
            wait_until(lambda: server.metric("lightfit_workers_busy") == 1, "the search begins")
        else:
            wait_until(lambda: server.metric("lightfit_readback_memory_bytes") > 0, "upload begins")
            assert server.metric("lightfit_calls_in_flight", f'method="{method}"') == 1
    finally:
        process.kill()
        process.wait()
    server.wait_until_idle()
    wait_until(lambda: server.num_files() <= num_files, "its connection is closed")
    record = the_call(server)
    assert record["method"] == method and record["code"] != "OK", record
    assert is_well(server.address)
