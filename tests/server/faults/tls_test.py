"""Certificates that change while calls come in, and clients with the wrong ones, or none."""

import itertools
import pathlib
import shutil
import socket
import ssl
import threading
import time
from typing import Any, List, Optional, Tuple

import grpc

import lightfit
from serving import Server, make_certificate, make_certificates, wait_until
from workload import UNAVAILABLE, small_readback, stub_of, whole_request

NAME = "lightfit.test"


def tls_options(folder: pathlib.Path) -> Tuple[Any, ...]:
    return (
        *("--tls-certificate", folder / "server.pem", "--tls-key", folder / "server.key"),
        *("--tls-reload-s", 0.1),
    )


def connect(address: str, ca: pathlib.Path, identity: Optional[pathlib.Path] = None) -> Any:
    """A channel with a connection, and so a handshake, of its own. identity: "NAME" of NAME.pem and
    NAME.key."""
    tls = lightfit.TlsOptions(
        ca=ca,
        cert=identity and identity.with_suffix(".pem"),
        key=identity and identity.with_suffix(".key"),
    )
    options = [("grpc.use_local_subchannel_pool", 1), ("grpc.ssl_target_name_override", NAME)]
    return grpc.secure_channel(address, tls.credentials(), options)


def fit_code(channel: Any) -> Any:
    """The status of a fit over the channel, which is closed."""
    with channel:
        call = stub_of(channel).Fit.future(whole_request(small_readback()), timeout=60)
        return call.code()


def served_certificate(server: Server, ca: pathlib.Path) -> bytes:
    """In DER, as a new connection is shown it."""
    context = ssl.create_default_context(cafile=str(ca))
    context.set_alpn_protocols(["h2"])
    host, port = server.address.split(":")
    with socket.create_connection((host, int(port))) as plain:
        with context.wrap_socket(plain, server_hostname=NAME) as connection:
            certificate = connection.getpeercert(binary_form=True)
    assert certificate is not None
    return certificate


def num_warnings(server: Server) -> int:
    """Of certificates without their key."""
    return sum("is not the key" in event["message"] for event in server.events("tls"))


def test_certificates_change_under_load(start: Any, tmp_path: pathlib.Path) -> None:
    folder = make_certificates(tmp_path / "studio")
    ca = folder / "ca.pem"
    server = start(*tls_options(folder))
    codes: List[Any] = []
    is_over = threading.Event()

    def shake_hands() -> None:
        while not is_over.is_set():
            codes.append(fit_code(connect(server.address, ca)))

    clients = [threading.Thread(target=shake_hands) for _ in range(4)]
    for client in clients:
        client.start()
    try:
        for number in range(3):
            make_certificate(folder, f"next {number}")
            new = ssl.PEM_cert_to_DER_cert((folder / f"next {number}.pem").read_text())
            shutil.copyfile(folder / f"next {number}.pem", folder / "server.pem")
            wait_until(lambda: num_warnings(server) == number + 1, "certificate without its key")
            assert served_certificate(server, ca) != new
            shutil.copyfile(folder / f"next {number}.key", folder / "server.key")
            wait_until(lambda: served_certificate(server, ca) == new, "the new certificate")
    finally:
        is_over.set()
        for client in clients:
            client.join()
    print(f"{len(codes)} connections during 3 rotations")
    assert len(codes) > 20 and set(codes) == {grpc.StatusCode.OK}


def test_a_file_that_is_half_written_changes_nothing(start: Any, tmp_path: pathlib.Path) -> None:
    folder = make_certificates(tmp_path / "studio")
    ca, path = folder / "ca.pem", folder / "server.pem"
    server = start(*tls_options(folder))
    whole = path.read_bytes()
    before = served_certificate(server, ca)
    for size in (0, 1, 100, len(whole) // 2, len(whole) - 3):
        path.write_bytes(whole[:size])
        time.sleep(0.3)
        assert served_certificate(server, ca) == before
    path.unlink()
    time.sleep(0.3)
    assert fit_code(connect(server.address, ca)) is grpc.StatusCode.OK
    assert [e for e in server.events("tls") if "previous files" in e["message"]]


def test_strangers_are_refused_and_disturb_nobody(start: Any, tmp_path: pathlib.Path) -> None:
    studio, other = (make_certificates(tmp_path / name) for name in ("studio", "other"))
    server = start(*tls_options(studio), "--tls-client-ca", studio / "ca.pem")
    num_files = server.num_files()
    member = (studio / "ca.pem", studio / "client")
    with connect(server.address, *member) as channel:
        fit = stub_of(channel).Fit
        for stranger in itertools.chain.from_iterable(
            [
                (studio / "ca.pem", other / "client"),  # certificate of another CA
                (studio / "ca.pem", None),  # none
                (other / "ca.pem", studio / "client"),  # trusts another CA
            ]
            for _ in range(5)
        ):
            assert fit_code(connect(server.address, *stranger)) is UNAVAILABLE
            assert len(fit(whole_request(small_readback()), timeout=60).lights) == 3
        plain = grpc.insecure_channel(server.address, [("grpc.use_local_subchannel_pool", 1)])
        assert fit_code(plain) is UNAVAILABLE
        assert fit_code(connect(server.address, *member)) is grpc.StatusCode.OK
    assert {record["code"] for record in server.events("call")} == {"OK"}
    wait_until(lambda: server.num_files() <= num_files, "all connections are closed")
