"""Proxies of the environment: this machine is reached without them, and they are named where others
do not answer."""

from __future__ import annotations

import contextlib
import os
import pathlib
import socket
import subprocess
import sys
import threading
from typing import Iterator, List, Tuple

import pytest

import lightfit
from lightfit.proxy import hosts_of, is_this_machine, proxy_of
from serving import REPOSITORY, Server, program

VARIABLES = ("grpc_proxy", "https_proxy", "http_proxy")
EXCEPTIONS = ("no_grpc_proxy", "no_proxy")


@pytest.fixture(autouse=True)
def without_proxies(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in (*VARIABLES, *EXCEPTIONS):
        for spelling in (name, name.upper()):
            monkeypatch.delenv(spelling, raising=False)


@contextlib.contextmanager
def refusing_proxy() -> Iterator[Tuple[str, List[str]]]:
    """Its URL, and the first lines of what it was asked."""
    listener = socket.create_server(("127.0.0.1", 0))
    asked: List[str] = []

    def serve() -> None:
        while True:
            try:
                connection, _ = listener.accept()
            except OSError:
                return
            with connection:
                asked.append(connection.recv(4096).decode().split("\r\n")[0])
                connection.sendall(b"HTTP/1.1 403 Forbidden\r\n\r\n")

    thread = threading.Thread(target=serve, daemon=True)
    thread.start()
    try:
        yield f"http://user:secret@127.0.0.1:{listener.getsockname()[1]}", asked
    finally:
        listener.shutdown(socket.SHUT_RDWR)
        listener.close()
        thread.join(timeout=10)


@pytest.mark.parametrize("variable", VARIABLES)
def test_this_machine_is_asked_directly(
    variable: str, server: Server, monkeypatch: pytest.MonkeyPatch
) -> None:
    port = server.address.rpartition(":")[2]
    with refusing_proxy() as (proxy, asked):
        monkeypatch.setenv(variable, proxy)
        spellings = ("127.0.0.1", "localhost", "LOCALHOST", "ipv4:127.0.0.1", "dns:///localhost")
        for host in spellings:
            with lightfit.Client(f"{host}:{port}", retries=0) as client:
                assert client.health() == "SERVING", host
        several = f"127.0.0.1:{port},127.0.0.1:{port}"
        with lightfit.Client(several, retries=0) as client:
            assert client.health() == "SERVING"
    assert asked == []


def test_sockets_in_the_file_system_are_asked_directly(
    has_serve: None, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    address = f"unix:{tmp_path}/socket"
    server = Server(listen=address)
    try:
        monkeypatch.setenv("http_proxy", "http://127.0.0.1:9")
        with lightfit.Client(address, retries=0) as client:
            assert client.health() == "SERVING"
    finally:
        assert server.stop() == 0


# An address for documentation (RFC 5737): nobody has it, and here nobody asks for it but a proxy.
ELSEWHERE = "192.0.2.7:50071"


@pytest.mark.parametrize("variable", VARIABLES)
def test_others_are_asked_through_it_and_both_are_named(
    variable: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    with refusing_proxy() as (proxy, asked):
        monkeypatch.setenv(variable, proxy)
        with lightfit.Client(ELSEWHERE, retries=0) as client:
            with pytest.raises(lightfit.UnavailableError) as caught:
                client.health()
    assert asked[0] == f"CONNECT {ELSEWHERE} HTTP/1.1" or asked[0].startswith(f"CONNECT {ELSEWHERE}")
    message = str(caught.value)
    where = proxy.replace("user:secret@", "")
    assert message.startswith(f"{ELSEWHERE}: ")
    assert f"through the proxy {where} that {variable} names" in message
    assert "add 192.0.2.7 to no_proxy" in message
    assert "secret" not in message


def test_a_proxy_that_is_not_there_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("http_proxy", "http://127.0.0.1:9")
    with lightfit.Client(ELSEWHERE, retries=0) as client, client.track((8, 8)) as track:
        with pytest.raises(lightfit.UnavailableError, match="192.0.2.7:50071.*http://127.0.0.1:9"):
            client.health()
        assert track.state == ()


def test_without_a_proxy_the_address_is_named() -> None:
    with lightfit.Client("127.0.0.1:1", retries=0) as client:
        with pytest.raises(lightfit.UnavailableError) as caught:
            client.health()
    assert str(caught.value).startswith("127.0.0.1:1: ")
    assert "is lightfit serve running there?" in str(caught.value)
    assert "proxy" not in str(caught.value)


PROXY = {"http_proxy": "http://proxy:3128"}


@pytest.mark.parametrize(
    "exceptions, host",
    [
        ("*", "farm"),
        ("farm", "farm"),
        ("other, farm.lan", "FARM.lan"),
        (".lan", "farm.lan"),
        ("*.lan", "farm.lan"),
        ("farm.lan:50071", "farm.lan"),
        ("10.0.0.0/8", "10.1.2.3"),
        ("10.1.2.3", "10.1.2.3"),
        ("fd00::/8", "[fd00::7]"),
        ("localhost 10.1.2.3", "10.1.2.3"),
    ],
)
@pytest.mark.parametrize("variable", [*EXCEPTIONS, "NO_PROXY"])
def test_exceptions_are_honoured(variable: str, exceptions: str, host: str) -> None:
    assert proxy_of(f"{host}:50071", PROXY) is not None
    assert proxy_of(f"{host}:50071", {**PROXY, variable: exceptions}) is None
    assert proxy_of("192.0.2.7:1", {**PROXY, variable: ",other,198.51.100.0/24"}) is not None


def test_variables_count_as_they_do_for_grpc() -> None:
    def variable(**environment: str) -> str:
        proxy = proxy_of("farm:1", environment)
        return "" if proxy is None else f"{proxy.variable} {proxy.address}"

    first, second = "http://a:1", "http://u:p@b:2"
    assert variable() == ""
    assert variable(http_proxy=first, https_proxy=second) == "https_proxy http://b:2"
    assert variable(https_proxy=first, grpc_proxy=second) == "grpc_proxy http://b:2"
    for none in ("", "socks5://a:1", "a:1", "http://"):  # which gRPC does not take
        assert variable(grpc_proxy=none, http_proxy=first) == ""


@pytest.mark.parametrize(
    "host", ["127.0.0.1", "127.9.9.9", "127.1", "::1", "LocalHost", "localhost.", "a.localhost",
             "::ffff:127.0.0.1", "0.0.0.0", "::"],
)
def test_this_machine_has_many_names(host: str) -> None:
    assert is_this_machine(host)


@pytest.mark.parametrize("host", ["128.0.0.1", "localhosts", "mylocalhost", "::2", "farm", ""])
def test_others_do_not(host: str) -> None:
    assert not is_this_machine(host)


@pytest.mark.parametrize(
    "target, hosts",
    [
        ("farm:1", ["farm"]),
        ("dns:farm:1", ["farm"]),
        ("dns:///farm:1", ["farm"]),
        ("dns://8.8.8.8/farm:1", ["farm"]),
        ("ipv4:10.0.0.1:5,10.0.0.2:6", ["10.0.0.1", "10.0.0.2"]),
        ("ipv6:[::1]:5", ["::1"]),
        ("[fe80::1%eth0]:5", ["fe80::1%eth0"]),
        ("unix:/tmp/s", []),
        ("unix:///tmp/s", []),
        ("unix-abstract:s", []),
    ],
)
def test_targets_name_hosts(target: str, hosts: List[str]) -> None:
    assert hosts_of(target) == hosts


def test_it_holds_for_a_program_that_was_started_with_a_proxy(server: Server) -> None:
    environment = {**os.environ, "http_proxy": "http://127.0.0.1:9"}
    done = subprocess.run(
        [sys.executable, "-c", f"import lightfit; print(lightfit.Client({server.address!r}).health())"],
        env=environment, capture_output=True, text=True,
    )
    assert done.stdout == "SERVING\n", done.stderr


def test_the_shared_case_is_served(tmp_path: pathlib.Path) -> None:
    case = REPOSITORY.parent / "shared" / "cases" / "client_behind_proxy" / "run.sh"
    if not case.exists():
        pytest.skip(f"{case} is absent")
    build = pathlib.Path(program()).parents[1]
    done = subprocess.run(["sh", case, build], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0 and "SERVING" in done.stdout, done.stderr
