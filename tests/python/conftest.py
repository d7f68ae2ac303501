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
    """What `lightfit fit` writes, without the yardsticks that the calls do not compute; with the
    border that they have where none is given."""

    def fit(*arguments: Any) -> result_pb2.FitResult:
        path = tmp_path / "fit.json"
        if "--border" not in arguments:
            arguments += ("--border", "lit")
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
def cast(tmp_path_factory: pytest.TempPathFactory) -> lightfit.ExrReadback:
    """A read-back by `lightfit render`, which knows what faces its lights."""
    pytest.importorskip("lightfit._native")
    folder = tmp_path_factory.mktemp("cast")
    exr, lights = folder / "a.exr", folder / "a.json"
    done = subprocess.run(
        [program(), "render", "generate:objects=10,triangles=3000", "--camera",
         "0,1.7,18:0,0.5,0", "--light", "low=sun:1,-0.6,0.3", "--light", "lamp=point:-4,6,5",
         "--size", "120x80", "-o", str(exr), "--lights-out", str(lights), "--quiet"],
        capture_output=True, text=True,
    )
    assert done.returncode == 0, done.stderr
    return lightfit.read_exr(exr, lights)


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
