"""examples/node: a client that knows the schema alone."""

from __future__ import annotations

import json
import pathlib
from typing import Any

import pytest

import lightfit
from conftest import EXAMPLES, fit_result, of_pixels
from serving import Server


def test_it_gets_the_matrices_of_the_library(
    node_client: Any, server: Server, scene: pathlib.Path, files: pathlib.Path
) -> None:
    expected = lightfit.fit_exr(scene / "0001.exr", scene / "scene.json", (1024, 1024))
    assert fit_result(node_client(server.address, files)) == of_pixels(expected.message)


def test_it_says_what_the_server_says(
    node_client: Any, server: Server, files: pathlib.Path
) -> None:
    (files / "shadow.u32").write_bytes(b"\0" * 8)
    done = node_client(server.address, files)
    assert done.returncode == 1 and done.stdout == ""
    assert "INVALID_ARGUMENT" in done.stderr and "shadow_bits" in done.stderr


def test_it_says_that_there_is_no_server(node_client: Any, files: pathlib.Path) -> None:
    done = node_client("127.0.0.1:1", files)
    assert done.returncode == 1
    assert "UNAVAILABLE" in done.stderr and "127.0.0.1:1" in done.stderr
    assert "proxy" not in done.stderr


@pytest.mark.parametrize("variable", ["grpc_proxy", "https_proxy", "http_proxy"])
def test_proxies_are_for_other_machines(
    node_client: Any, server: Server, files: pathlib.Path, variable: str,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv(variable, "http://127.0.0.1:9")
    assert node_client(server.address, files).returncode == 0
    done = node_client("192.0.2.7:50071", files)
    assert done.returncode == 1
    assert "192.0.2.7:50071" in done.stderr and f"through {variable}" in done.stderr


def test_it_is_a_page() -> None:
    assert len((EXAMPLES / "node" / "fit.mjs").read_text().splitlines()) <= 40


def test_its_packages_are_pinned_by_their_checksums_and_come_from_the_registry_of_npm() -> None:
    lock = json.loads((EXAMPLES / "node" / "package-lock.json").read_text())
    packages = {name: package for name, package in lock["packages"].items() if name}
    assert len(packages) > 2
    for name, package in packages.items():
        assert package["integrity"].startswith("sha512-"), name
        assert package.get("resolved", "https://registry.npmjs.org/").startswith(
            "https://registry.npmjs.org/"
        ), name
