"""What the tests share: the examples, the program, and a real server."""

from __future__ import annotations

import pathlib
import subprocess
from typing import Any, Callable, Iterator

import pytest
from google.protobuf import json_format

import lightfit
from lightfit.v1 import result_pb2
from serving import REPOSITORY, Server, program

YARD = REPOSITORY / "examples" / "yard_180"
ROOM = REPOSITORY / "examples" / "room_180"


@pytest.fixture
def run_lightfit() -> Callable[..., "subprocess.CompletedProcess[str]"]:
    """Runs the program with these arguments and gives what it said."""

    def run(*arguments: Any) -> "subprocess.CompletedProcess[str]":
        return subprocess.run(
            [program(), *map(str, arguments)], capture_output=True, text=True, timeout=300
        )

    return run


@pytest.fixture
def fit_by_program(
    tmp_path: pathlib.Path, run_lightfit: Any
) -> Callable[..., result_pb2.FitResult]:
    """What `lightfit fit` writes, without the yardsticks that the calls do not compute."""

    def fit(*arguments: Any) -> result_pb2.FitResult:
        path = tmp_path / "fit.json"
        done = run_lightfit("fit", *arguments, "--map", "1024x1024", "--json", path, "--quiet")
        assert path.exists(), done.stderr
        result = json_format.Parse(path.read_text(), result_pb2.FitResult())
        for light in result.lights:
            without_yardsticks(light)
        return result

    return fit


def without_yardsticks(light: result_pb2.LightResult) -> None:
    for field in ("focused", "as_published", "final_over_focused", "final_over_as_published"):
        light.energies.ClearField(field)
    if not light.energies.ByteSize():
        light.ClearField("energies")
    light.foretold_wrong.ClearField("focused")
    light.foretold_wrong.ClearField("as_published")
    if not light.status.code:
        assert light.HasField("foretold_wrong")
    else:
        light.ClearField("foretold_wrong")


@pytest.fixture(scope="session")
def yard() -> lightfit.ExrReadback:
    pytest.importorskip("lightfit._native")
    return lightfit.read_exr(YARD / "0001.exr", YARD / "scene.json")


@pytest.fixture(scope="session")
def has_serve() -> None:
    done = subprocess.run([program(), "serve", "--help"], capture_output=True)
    if b"--listen" not in done.stdout:
        pytest.skip("this lightfit has no verb serve")


@pytest.fixture(scope="session")
def server(has_serve: None) -> Iterator[Server]:
    running = Server()
    yield running
    assert running.stop() == 0


@pytest.fixture
def client(server: Server) -> Iterator[lightfit.Client]:
    with lightfit.Client(server.address) as connected:
        yield connected
