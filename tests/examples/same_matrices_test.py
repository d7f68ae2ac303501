"""One server, and clients in three languages: the matrices of the library, to the last bit."""

from __future__ import annotations

import os
import pathlib
import struct
import subprocess
from typing import Any, List

import pytest
from google.protobuf import json_format

import lightfit
from conftest import command_line, fit_result, of_pixels
from lightfit.v1 import result_pb2
from serving import Server, program


@pytest.fixture
def expected(scene: pathlib.Path) -> result_pb2.FitResult:
    """The library, in this process."""
    result = lightfit.fit_exr(scene / "0001.exr", scene / "scene.json", (1024, 1024)).message
    assert any(light.status.code == 0 for light in result.lights)
    return result


def bits(result: result_pb2.FitResult) -> List[bytes]:
    """Of the matrices of all lights; empty for a light without."""
    return [
        struct.pack(f"<{len(matrix.m)}d", *matrix.m)
        for light in result.lights
        for matrix in (light.map_from_world, light.clip_from_world)
    ]


def test_the_program_writes_them(
    expected: result_pb2.FitResult, scene: pathlib.Path, tmp_path: pathlib.Path
) -> None:
    path = tmp_path / "fit.json"
    subprocess.run(
        [program(), "fit", scene / "0001.exr", "--lights", scene / "scene.json", "--map",
         "1024x1024", "--json", path, "--quiet"],
        capture_output=True,
        timeout=120,
    )  # exit code 3 where a light has no matrix
    written = json_format.Parse(path.read_text(), result_pb2.FitResult())
    assert bits(written) == bits(expected)
    assert [light.status for light in written.lights] == [
        light.status for light in expected.lights
    ]


def test_the_python_client_gets_them(
    expected: result_pb2.FitResult, server: Server, scene: pathlib.Path
) -> None:
    with lightfit.Client(server.address) as client:
        got = client.fit_exr(scene / "0001.exr", scene / "scene.json", (1024, 1024))
    assert bits(got.message) == bits(expected)
    assert got.message == expected


def test_the_cpp_client_gets_them(
    expected: result_pb2.FitResult, server: Server, files: pathlib.Path
) -> None:
    got = fit_result(command_line([cpp_client()])(server.address, files))
    assert bits(got) == bits(expected)
    assert got == of_pixels(expected)


def test_the_node_client_gets_them(
    node_client: Any, expected: result_pb2.FitResult, server: Server, files: pathlib.Path
) -> None:
    got = fit_result(node_client(server.address, files))
    assert bits(got) == bits(expected)
    assert got == of_pixels(expected)


def test_the_cpp_client_says_what_the_server_says(server: Server, files: pathlib.Path) -> None:
    (files / "depth.f32").write_bytes(b"")
    done = command_line([cpp_client()])(server.address, files)
    assert done.returncode == 1 and done.stdout == ""
    assert "depth" in done.stderr


@pytest.mark.parametrize("variable", ["grpc_proxy", "https_proxy", "http_proxy"])
def test_proxies_are_for_other_machines(
    server: Server, files: pathlib.Path, variable: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    client = command_line([cpp_client()])
    monkeypatch.setenv(variable, "http://127.0.0.1:9")
    assert client(server.address, files).returncode == 0
    done = client("192.0.2.7:50071", files)
    assert done.returncode == 1
    assert "192.0.2.7:50071: " in done.stderr and f"through {variable}" in done.stderr


def cpp_client() -> str:
    path = os.environ.get("LIGHTFIT_CPP_CLIENT", "")
    if not os.access(path, os.X_OK):
        pytest.skip("LIGHTFIT_CPP_CLIENT names no program: build the target cpp_client")
    return path
