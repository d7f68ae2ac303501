"""Pings on a connection without calls, as clients send them to keep it."""

import socket
import struct
from typing import Any, Tuple

HTTP2_PREFACE = b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n"
SETTINGS, PING, GOAWAY = 4, 6, 7
ACK = 1

# One every ten seconds.
PINGS_OF_A_DAY = 8640


def frame(kind: int, payload: bytes, flags: int = 0) -> bytes:
    """Of stream 0."""
    return struct.pack(">I", len(payload))[1:] + bytes((kind, flags, 0, 0, 0, 0)) + payload


def read_frame(connection: Any) -> Tuple[int, int, bytes]:
    """Type, flags and payload."""
    head = connection.read(9)
    assert len(head) == 9, "the server hung up"
    return head[3], head[4], connection.read(int.from_bytes(head[:3], "big"))


def test_a_day_of_pings_is_answered(start: Any) -> None:
    server = start()
    host, port = server.address.split(":")
    with socket.create_connection((host, int(port)), timeout=20) as plain:
        plain.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        plain.sendall(HTTP2_PREFACE + frame(SETTINGS, b""))
        with plain.makefile("rb") as connection:
            for number in range(PINGS_OF_A_DAY):
                words = struct.pack(">Q", number)
                plain.sendall(frame(PING, words))
                while True:
                    kind, flags, payload = read_frame(connection)
                    assert kind != GOAWAY, f"ping {number}: {payload[8:].decode()}"
                    if kind == SETTINGS and not flags & ACK:
                        plain.sendall(frame(SETTINGS, b"", ACK))
                    if kind == PING and flags & ACK:
                        assert payload == words
                        break
