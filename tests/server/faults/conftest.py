"""Servers to be maltreated. What is shared with the tests of the package is in tests/python."""

from __future__ import annotations

from typing import Any, Callable, Iterator, List

import pytest

from serving import Server


@pytest.fixture
def start() -> Iterator[Callable[..., Server]]:
    """Starts a server with these options. Those that are still there after the test must drain in
    peace; of all of them every line of the log is JSON."""
    servers: List[Server] = []

    def start_one(*arguments: Any, **options: Any) -> Server:
        servers.append(Server(*arguments, **options))
        return servers[-1]

    try:
        yield start_one
        for server in servers:
            if server.process.poll() is None:
                assert server.stop() == 0, "".join(server.log[-20:])
            for line in server.log_lines():
                assert {"time", "level", "event"} <= set(line), line
    finally:
        for server in servers:
            server.kill()
