"""Clients that do not speak the protocol."""

import random
import re
import socket
import ssl
import struct
from typing import Any, Callable, Iterable, List

import grpc
import pytest

from serving import Server, wait_until
from workload import connect, is_well, small_readback, stream_requests, track_requests

SEED = 20231

HTTP2_PREFACE = b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n"
SETTINGS = b"\0\0\0\x04\0\0\0\0\0"


def open_socket(address: str) -> socket.socket:
    host, port = address.split(":")
    return socket.create_connection((host, int(port)), timeout=20)


def say(address: str, words: bytes) -> None:
    """Sends them, and hangs up when the server does, or has nothing to say."""
    with open_socket(address) as connection:
        try:
            connection.sendall(words)
            connection.shutdown(socket.SHUT_WR)
            while connection.recv(4096):
                pass
        except OSError:
            pass  # the server hung up first


def bad_words() -> List[bytes]:
    print(f"seed {SEED}")
    source = random.Random(SEED)
    noise = [source.randbytes(source.choice((1, 9, 100, 5000, 200000))) for _ in range(60)]
    frames = [
        # Any type and flags, lengths up to what is there or beyond.
        source.randrange(1 << source.choice((4, 14, 24))).to_bytes(3, "big")
        + source.randbytes(source.randrange(400))
        for _ in range(100)
    ]
    return [
        *noise,
        *(HTTP2_PREFACE + words for words in noise),
        *(HTTP2_PREFACE + SETTINGS + words for words in frames),
        *(HTTP2_PREFACE[:size] for size in range(1, len(HTTP2_PREFACE))),
        b"GET / HTTP/1.1\r\nHost: lightfit\r\n\r\n",
        b"POST /lightfit.v1.LightFit/Fit HTTP/1.1\r\nContent-Length: 1000000\r\n\r\n" + bytes(5000),
        b"\r\n" * 1000,
        b"\x16\x03\x01",
    ]


UNARY = ("Fit", "FitSummary", "Evaluate", "Allocate", "Summarize", "Compare")

# Field 1 is said to have 100 bytes, and has three.
CUT_SHORT = b"\x0a\x64abc"


def refusal_of(call: Callable[[], Any]) -> str:
    """That the call is refused for what was sent, and the words."""
    with pytest.raises(grpc.RpcError) as caught:
        call()
    assert caught.value.code() is grpc.StatusCode.INVALID_ARGUMENT, caught.value
    return str(caught.value.details())


def track_of(channel: Any, requests: Iterable[bytes], answers: List[bytes]) -> None:
    for answer in channel.stream_stream("/lightfit.v1.LightFit/Track")(iter(requests), timeout=20):
        answers.append(answer)


def is_alive(server: Server) -> bool:
    return server.process.poll() is None and is_well(server.address)


def test_noise_is_survived(start: Any) -> None:
    server = start("--log-level", "warning")
    assert is_well(server.address)
    num_files = server.num_files()
    for words in bad_words():
        say(server.address, words)
    assert is_alive(server)
    wait_until(lambda: server.num_files() <= num_files, "the connections are closed")
    for words in bad_words():
        say(server.metrics_address, words)
    assert is_alive(server)
    assert server.metric("lightfit_build_info") == 1


def test_tls_to_a_plain_port_is_refused(start: Any) -> None:
    server = start()
    context = ssl.create_default_context()
    for _ in range(20):
        with open_socket(server.address) as plain, pytest.raises((ssl.SSLError, OSError)):
            context.wrap_socket(plain, server_hostname="lightfit.test")
    assert is_alive(server)


def test_connections_that_say_nothing_hold_nobody_up(start: Any) -> None:
    server = start()
    assert is_well(server.address)
    num_files = server.num_files()
    silent = [open_socket(server.address) for _ in range(300)]
    for number, connection in enumerate(silent):
        connection.sendall((b"", HTTP2_PREFACE[:9], HTTP2_PREFACE)[number % 3])
    assert is_alive(server)
    for number, connection in enumerate(silent):
        if number % 2 == 0:  # not a word of goodbye: the peer is reset
            connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        connection.close()
    wait_until(lambda: server.num_files() <= num_files, "the connections are closed")
    assert is_alive(server)


def test_messages_of_noise_are_refused(start: Any) -> None:
    server = start()
    print(f"seed {SEED}")
    source = random.Random(SEED)
    with connect(server.address) as channel:
        for number in range(200):
            noise = source.randbytes(source.choice((1, 10, 100, 10000)))
            unary = channel.unary_unary(f"/lightfit.v1.LightFit/{UNARY[number % len(UNARY)]}")
            refusal_of(lambda: unary(noise, timeout=20))
            pieces = [source.randbytes(source.choice((1, 10, 10000))) for _ in range(3)]
            stream = channel.stream_unary("/lightfit.v1.LightFit/FitStream")
            refusal_of(lambda: stream(iter(pieces), timeout=20))
            refusal_of(lambda: track_of(channel, pieces, []))
        with pytest.raises(grpc.RpcError) as caught:
            channel.unary_unary("/lightfit.v1.LightFit/NoSuchMethod")(b"", timeout=20)
        assert caught.value.code() is grpc.StatusCode.UNIMPLEMENTED
    server.wait_until_idle()
    assert is_alive(server)


def test_a_message_that_cannot_be_parsed_is_an_error_wherever_it_comes(start: Any) -> None:
    server = start()
    track = [message.SerializeToString() for message in track_requests([small_readback()] * 2)]
    upload = [message.SerializeToString() for message in stream_requests(small_readback())]
    with connect(server.address) as channel:
        for end in range(len(track) + 1):
            answers: List[bytes] = []
            words = refusal_of(lambda: track_of(channel, [*track[:end], CUT_SHORT], answers))
            assert "message cannot be parsed, want lightfit.v1.TrackRequest" in words
            assert len(answers) == max(0, end - 1) // (len(track) // 2)  # the frames before it
        stream = channel.stream_unary("/lightfit.v1.LightFit/FitStream")
        for end in range(len(upload)):
            words = refusal_of(lambda: stream(iter([*upload[:end], CUT_SHORT]), timeout=20))
            assert "message cannot be parsed, want lightfit.v1.FitStreamRequest" in words
        for method in UNARY:
            unary = channel.unary_unary(f"/lightfit.v1.LightFit/{method}")
            words = refusal_of(lambda: unary(CUT_SHORT, timeout=20))
            assert f"message cannot be parsed, want lightfit.v1.{method}Request" in words
        track_of(channel, track, answers := [])
        assert len(answers) == 2  # as ever
    server.wait_until_idle()


def test_request_ids_cannot_forge_lines_of_the_log(start: Any) -> None:
    server = start()
    forged = [b'","event":"stop', b"a" * 500, b"\\u0000 {}[]", b"fine 1"]
    with connect(server.address) as channel:
        call = channel.unary_unary("/lightfit.v1.LightFit/Fit")
        for name in forged:
            with pytest.raises(grpc.RpcError) as caught:
                call(b"", timeout=20, metadata=[("x-request-id", name.decode())])
            assert caught.value.code() is grpc.StatusCode.INVALID_ARGUMENT
    wait_until(lambda: len(server.events("call")) == len(forged), "the log names the calls")
    names = [record["request_id"] for record in server.events("call")]
    assert names[0] == forged[0].decode() and names[2:] == [n.decode() for n in forged[2:]]
    assert re.fullmatch("[0-9a-f]{16}", names[1])
    assert not server.events("stop")
