"""A client that waits to be killed: doomed_client.py ADDRESS METHOD half|all

Sends half of the messages of a long call, or all of them."""

import itertools
import sys

from workload import (
    LONG,
    begin,
    connect,
    long_readback,
    stream_requests,
    stub_of,
    track_requests,
    until_killed,
)

address, method, share = sys.argv[1:]
stub = stub_of(connect(address))
if share == "all":
    call = begin(stub, method, long_readback(), LONG, timeout_s=None)
elif method == "FitStream":
    half = itertools.islice(stream_requests(long_readback(), LONG), 4)
    call = stub.FitStream.future(itertools.chain(half, until_killed()))
else:
    half = itertools.islice(track_requests([long_readback()], LONG), 4)
    call = stub.Track(itertools.chain(half, until_killed()))
call.code()  # never comes
