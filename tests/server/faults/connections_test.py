"""Many connections at once."""

import concurrent.futures
import resource
from typing import Any

import pytest

from serving import wait_until
from workload import connect, is_well, small_readback, stub_of, whole_request

NUM_CONNECTIONS = 1000


def test_a_thousand_connections_come_and_go(start: Any) -> None:
    _, most_files = resource.getrlimit(resource.RLIMIT_NOFILE)
    if most_files < 2 * NUM_CONNECTIONS:
        pytest.skip(f"{most_files} files at most (ulimit -Hn), want {2 * NUM_CONNECTIONS}")
    resource.setrlimit(resource.RLIMIT_NOFILE, (most_files, most_files))
    server = start("--log-level", "warning")
    assert is_well(server.address)
    num_files = server.num_files()
    channels = [connect(server.address) for _ in range(NUM_CONNECTIONS)]
    request = whole_request(small_readback(), {"search": "focused"})

    def num_lights(channel: Any) -> int:
        return len(stub_of(channel).Fit(request, timeout=120).lights)

    with concurrent.futures.ThreadPoolExecutor(100) as threads:
        assert set(threads.map(num_lights, channels)) == {3}
    assert server.num_files() >= NUM_CONNECTIONS
    print(f"{server.peak_memory_bytes() >> 20} MiB with {server.num_files()} files")
    server.wait_until_idle()
    assert is_well(server.address)  # while all the others idle
    assert num_lights(channels[NUM_CONNECTIONS // 2]) == 3
    for channel in channels:
        channel.close()
    wait_until(lambda: server.num_files() <= num_files + 10, "the connections are closed")
    assert is_well(server.address)
