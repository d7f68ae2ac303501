"""Memory, while many clients send large read-backs."""

import collections
import threading
from typing import Any, Dict, List, Optional

import grpc

from lightfit.channel import error_of_call
from lightfit.errors import BusyError, LightfitError, UnavailableError
from lightfit.retry import RetryPolicy, call_with_retries
from readbacks import large_readback
from workload import connect, is_well, stream_requests, stub_of

NUM_CLIENTS = 64
WIDTH, HEIGHT = 3840, 2160
MEMORY_MIB = 512

# Half as much again for what the network layer holds, and what the process needs by itself.
LIMIT_MIB = 1.5 * MEMORY_MIB + 250


def test_it_is_bounded_while_64_clients_send_4k(start: Any) -> None:
    server = start("--memory-mib", MEMORY_MIB, "--log-level", "error")
    readback = large_readback(WIDTH, HEIGHT)
    outcomes: Dict[str, int] = collections.Counter()
    failures: List[LightfitError] = []

    def client() -> None:
        with connect(server.address) as channel:
            stub = stub_of(channel)

            def attempt(timeout_s: Optional[float]) -> Any:
                requests = stream_requests(readback, {"search": "focused"})
                try:
                    return stub.FitStream(requests, timeout=timeout_s)
                except grpc.RpcError as rpc_error:
                    error = error_of_call(rpc_error, None)
                    outcomes[error.code] += 1
                    if not isinstance(error, (BusyError, UnavailableError)):
                        failures.append(error)
                    raise error from None

            try:
                result = call_with_retries(attempt, RetryPolicy(retries=1000), timeout_s=240)
                assert [light.status.code for light in result.lights] == [0, 0, 0]
                outcomes["OK"] += 1
            except LightfitError as error:
                failures.append(error)

    clients = [threading.Thread(target=client) for _ in range(NUM_CLIENTS)]
    for thread in clients:
        thread.start()
    for thread in clients:
        thread.join()
    peak_mib = server.peak_memory_bytes() / (1 << 20)
    print(f"{dict(outcomes)}; the server took {peak_mib:.0f} of {LIMIT_MIB:.0f} MiB")
    assert failures == [] and outcomes["OK"] == NUM_CLIENTS
    assert outcomes["RESOURCE_EXHAUSTED"] > 0  # or it was no load
    assert peak_mib < LIMIT_MIB
    server.wait_until_idle()
    assert is_well(server.address)
