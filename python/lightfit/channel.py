"""Channels to servers, and what their failures mean."""

from __future__ import annotations

import dataclasses
import ipaddress
import json
import time
from pathlib import Path
from typing import Any, List, Optional, Set, Tuple

import grpc

from lightfit.errors import BusyError, InvalidArgumentError, LightfitError, error_of
from lightfit.inputs import Path_
from lightfit.proxy import Proxy, proxy_of

SERVICE = "lightfit.v1.LightFit"

_SCHEMES = ("unix:", "unix-abstract:", "dns:", "ipv4:", "ipv6:")
_ROUND_ROBIN = {
    "loadBalancingConfig": [{"round_robin": {}}],
    "healthCheckConfig": {"serviceName": SERVICE},
}


@dataclasses.dataclass(frozen=True)
class TlsOptions:
    """Files in PEM format.

    ca: what the server's certificate is checked against; None: what gRPC trusts by itself.
    cert, key: the client's own, where the server asks for one.
    server_name: the name in the server's certificate, where it is not that of the address.
    """

    ca: Optional[Path_] = None
    cert: Optional[Path_] = None
    key: Optional[Path_] = None
    server_name: Optional[str] = None

    def credentials(self) -> Any:
        if (self.cert is None) != (self.key is None):
            raise InvalidArgumentError("tls: has only one of cert and key, want both or neither")
        return grpc.ssl_channel_credentials(
            root_certificates=_file_bytes("ca", self.ca),
            private_key=_file_bytes("key", self.key),
            certificate_chain=_file_bytes("cert", self.cert),
        )


# What gRPC says when the two sides do not agree.
_TLS_WAYS_OUT = {
    "is not in peer certificate": "want tls: server_name=, a name that the server's certificate has",
    "certificate verify failed": "want tls: ca=, the authority that the server's certificate is by",
    "wrong version number": "the server speaks no TLS: leave tls out",
}


@dataclasses.dataclass(frozen=True)
class Peer:
    """Who is asked, for messages."""

    address: str
    proxy: Optional[Proxy] = None  # that stands between
    is_tls: bool = False

    def about(self, code: Any, details: str) -> str:
        """The details of a call that failed, with what helps to find out why."""
        if code is grpc.StatusCode.UNAVAILABLE:
            if self.proxy is None and "failed to connect" in details:
                details = f"{details}; {self._way_out(details)}"
            details = f"{self.address}: {details}"
        elif code is grpc.StatusCode.DEADLINE_EXCEEDED:
            details = f"{self.address}: no answer within timeout_s ({details})"
        else:
            return details
        return details if self.proxy is None else f"{details}; {self.proxy.about()}"

    def _way_out(self, details: str) -> str:
        for words, way_out in _TLS_WAYS_OUT.items():
            if words in details:
                return way_out
        if "Socket closed" not in details:
            return "is lightfit serve running there?"
        if self.is_tls:
            return "does the server ask for a certificate of yours, tls: cert= and key=?"
        return "does the server want TLS, tls=lightfit.TlsOptions(ca=...)?"


def open_channel(
    address: str, tls: Optional[TlsOptions], round_robin: Optional[bool]
) -> Tuple[Any, Peer]:
    target, is_many = target_of(address)
    proxy = proxy_of(target)
    options: List[Tuple[str, Any]] = [
        ("grpc.max_receive_message_length", -1),
        ("grpc.max_send_message_length", -1),
        # A server that starts again is found again soon.
        ("grpc.initial_reconnect_backoff_ms", 100),
        ("grpc.min_reconnect_backoff_ms", 1000),  # how long one attempt to connect may take
        ("grpc.max_reconnect_backoff_ms", 2000),
        ("grpc.enable_http_proxy", 0 if proxy is None else 1),
    ]
    if is_many if round_robin is None else round_robin:
        options.append(("grpc.service_config", json.dumps(_ROUND_ROBIN)))
    if tls is None:
        return grpc.insecure_channel(target, options), Peer(address, proxy)
    if tls.server_name:
        options.append(("grpc.ssl_target_name_override", tls.server_name))
    return grpc.secure_channel(target, tls.credentials(), options), Peer(address, proxy, True)


def target_of(address: str) -> Tuple[str, bool]:
    """The gRPC target of an address, and whether there may be many servers behind it."""
    if not isinstance(address, str) or not address:
        raise InvalidArgumentError(f'address = {address!r}, want one such as "127.0.0.1:50071"')
    if address.startswith(_SCHEMES):
        return address, "," in address or address.startswith("dns:")
    servers = [server.strip() for server in address.split(",")]
    versions: Set[int] = set()
    for server in servers:
        host, colon, port = server.rpartition(":")
        if not colon or not port.isdecimal() or not 1 <= int(port) <= 65535:
            raise InvalidArgumentError(
                f'address = {address!r}: "{server}" has no port, want HOST:PORT or unix:/path'
            )
        try:
            versions.add(ipaddress.ip_address(host.strip("[]")).version)
        except ValueError:
            versions.add(0)
    if len(servers) == 1:
        return servers[0], False
    if len(versions) > 1 or 0 in versions:
        raise InvalidArgumentError(
            f"address = {address!r}: several servers are named by their numbers, all IPv4 or all "
            "IPv6; want 10.0.0.1:50071,10.0.0.2:50071, or dns:///NAME:PORT for a name of many"
        )
    return f"ipv{versions.pop()}:{','.join(servers)}", True


def pause(channel: Any, wait_s: float) -> None:
    """Sleeps while the channel goes on connecting: where nobody waits for an answer or a state, gRPC
    looks after its connections only every 5 s."""

    def ignore(_: Any) -> None: ...

    channel.subscribe(ignore)
    try:
        time.sleep(wait_s)
    finally:
        channel.unsubscribe(ignore)


def error_of_call(
    error: Any, request_id: Optional[str], peer: Optional[Peer] = None
) -> LightfitError:
    """error: the grpc.RpcError of a call. peer: who did not answer."""
    number, _ = error.code().value
    message = " ".join((error.details() or error.code().name).split())
    if peer is not None:
        message = peer.about(error.code(), message)
    pushback_s = _pushback_s(error)
    result = error_of(number, message, request_id)
    if error.code() is grpc.StatusCode.RESOURCE_EXHAUSTED and pushback_s is not None:
        result = BusyError(message, request_id=request_id)
    result.retry_after_s = pushback_s
    return result


def _pushback_s(error: Any) -> Optional[float]:
    for key, value in error.trailing_metadata() or ():
        if key == "grpc-retry-pushback-ms":
            try:
                return int(value) / 1000.0
            except ValueError:
                return -1.0  # gRPC: what cannot be read means not to try again
    return None


def _file_bytes(field: str, path: Optional[Path_]) -> Optional[bytes]:
    if path is None:
        return None
    try:
        return Path(path).read_bytes()
    except OSError as error:
        raise InvalidArgumentError(f"tls: {field}: {path}: {error.strerror}") from None
