"""Proxies of the environment: which servers are asked directly, and what to say when one that is
asked through a proxy does not answer.

gRPC sends every connection through grpc_proxy, https_proxy or http_proxy, the first that is set,
those to this machine too; of no_proxy it knows ends of names alone. Here addresses of this machine
are never sent there, nor are those that NO_PROXY or no_proxy name, networks and * among them.
"""

from __future__ import annotations

import dataclasses
import ipaddress
import os
import socket
from typing import Iterable, List, Mapping, Optional, Tuple, Union
from urllib.parse import urlsplit

_VARIABLES = ("grpc_proxy", "https_proxy", "http_proxy")  # as gRPC looks
_EXCEPTIONS = ("no_grpc_proxy", "no_proxy", "NO_GRPC_PROXY", "NO_PROXY")

_IpAddress = Union[ipaddress.IPv4Address, ipaddress.IPv6Address]


@dataclasses.dataclass(frozen=True)
class Proxy:
    """What stands between."""

    variable: str  # where it is set
    address: str  # without user and password
    hosts: Tuple[str, ...]  # that are asked through it

    def about(self) -> str:
        """What to say of a server that did not answer."""
        return (
            f"it was asked through the proxy {self.address} that {self.variable} names; if it "
            f"needs none, add {','.join(self.hosts)} to no_proxy"
        )


def proxy_of(target: str, environment: Optional[Mapping[str, str]] = None) -> Optional[Proxy]:
    """The proxy that a gRPC target is to be reached through; None: directly."""
    environment = os.environ if environment is None else environment
    hosts = hosts_of(target)
    # A proxy cannot be asked for several addresses at once.
    if len(hosts) != 1 or is_this_machine(hosts[0]):
        return None
    for variable in _VARIABLES:
        if variable in environment:
            break
    else:
        return None
    try:
        url = urlsplit(environment[variable].strip())
    except ValueError:
        return None
    if url.scheme != "http" or not url.netloc:
        return None  # gRPC does not take it either
    exceptions = [environment[name] for name in _EXCEPTIONS if name in environment]
    if _is_excepted(hosts[0], ",".join(exceptions).replace(" ", ",").split(",")):
        return None
    return Proxy(variable, f"http://{url.netloc.rpartition('@')[2]}", tuple(hosts))


def hosts_of(target: str) -> List[str]:
    """The names or numbers in a gRPC target; none of a socket in the file system."""
    scheme, colon, rest = target.partition(":")
    if scheme in ("unix", "unix-abstract") and colon:
        return []
    if scheme in ("dns", "ipv4", "ipv6") and colon:
        target = rest.split("/", 3)[-1] if rest.startswith("//") else rest.lstrip("/")
    return [_host(server.strip()) for server in target.split(",")]


def is_this_machine(host: str) -> bool:
    """127.0.0.0/8, ::1, localhost and what else is another spelling of them."""
    name = host.lower().rstrip(".")
    if name in ("localhost", "localhost.localdomain") or name.endswith(".localhost"):
        return True
    number = _number(host)
    return number is not None and (number.is_loopback or number.is_unspecified)


def _is_excepted(host: str, exceptions: Iterable[str]) -> bool:
    name, number = host.lower().rstrip("."), _number(host)
    for entry in exceptions:
        entry = entry.strip().lower()
        if not entry:
            continue
        if entry == "*":
            return True
        if number is not None:
            try:
                if number in ipaddress.ip_network(entry.strip("[]"), strict=False):
                    return True
            except (TypeError, ValueError):
                pass
        if name.endswith(_host(entry.lstrip("*"))):
            return True
    return False


def _host(server: str) -> str:
    """Without its port."""
    if server.startswith("["):
        return server[1:].partition("]")[0]
    host, colon, port = server.rpartition(":")
    return host if colon and port.isdecimal() and ":" not in host else server


def _number(host: str) -> Optional[_IpAddress]:
    try:
        number = ipaddress.ip_address(host.strip("[]").partition("%")[0])
    except ValueError:
        if not host or host.strip("0123456789abcdefABCDEFxX."):
            return None
        try:
            number = ipaddress.ip_address(socket.inet_aton(host))  # 127.1
        except OSError:
            return None
    return getattr(number, "ipv4_mapped", None) or number
