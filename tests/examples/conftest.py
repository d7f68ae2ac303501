"""What the tests of the clients share: the real server, and one read-back in files."""

from __future__ import annotations

import os
import pathlib
import shutil
import subprocess
import sys
from typing import Callable, Iterator

import pytest
from google.protobuf import json_format

from lightfit.v1 import result_pb2
from serving import REPOSITORY, Server

EXAMPLES = REPOSITORY / "examples"

# What npm says where there is no way to the registry.
_NO_REGISTRY = ("ENOTFOUND", "EAI_AGAIN", "ECONNREFUSED", "ECONNRESET", "ETIMEDOUT", "ENETUNREACH")


@pytest.fixture(scope="session")
def server() -> Iterator[Server]:
    running = Server()
    yield running
    assert running.stop() == 0


@pytest.fixture(params=["yard_180", "room_180"])
def scene(request: pytest.FixtureRequest) -> pathlib.Path:
    """The folder of an example. In the room one light has no single map."""
    return EXAMPLES / request.param


@pytest.fixture
def files(scene: pathlib.Path, tmp_path: pathlib.Path) -> pathlib.Path:
    """A folder with request.json, depth.f32 and shadow.u32 of the example, maps of 1024x1024."""
    subprocess.run(
        [sys.executable, EXAMPLES / "write_request.py", scene / "0001.exr", scene / "scene.json",
         "1024x1024", tmp_path],
        check=True,
    )
    return tmp_path


Client = Callable[..., "subprocess.CompletedProcess[str]"]


def command_line(words: list) -> Client:
    """Runs `words ADDRESS request.json depth.f32 shadow.u32`."""

    def run(address: str, files: pathlib.Path) -> "subprocess.CompletedProcess[str]":
        names = [files / name for name in ("request.json", "depth.f32", "shadow.u32")]
        return subprocess.run(
            [*map(str, words), address, *map(str, names)],
            capture_output=True,
            text=True,
            timeout=120,
            env={**os.environ, "LIGHTFIT_PROTO": str(REPOSITORY / "proto")},
        )

    return run


def of_pixels(result: result_pb2.FitResult) -> result_pb2.FitResult:
    """The same for clients that send pixels and know of no file that they came from."""
    copy = result_pb2.FitResult()
    copy.CopyFrom(result)
    copy.readback.ClearField("origin")
    return copy


def fit_result(done: "subprocess.CompletedProcess[str]") -> result_pb2.FitResult:
    """What a client printed."""
    assert done.returncode == 0, done.stderr
    return json_format.Parse(done.stdout, result_pb2.FitResult())


@pytest.fixture(scope="session")
def node_client() -> Client:
    """examples/node, with its packages: installed from the lock file once for each build."""
    for program in ("node", "npm"):
        if shutil.which(program) is None:
            pytest.skip(f"{program} is absent")
    build = os.environ.get("LIGHTFIT_BUILD_DIR", str(REPOSITORY / "build/release"))
    folder = pathlib.Path(build) / "tests" / "examples" / "node"
    folder.mkdir(parents=True, exist_ok=True)
    for name in ("fit.mjs", "package.json", "package-lock.json"):
        shutil.copy(EXAMPLES / "node" / name, folder)
    installed = folder / "installed-package-lock.json"
    lock = (folder / "package-lock.json").read_text()
    if not installed.exists() or installed.read_text() != lock:
        done = subprocess.run(
            ["npm", "ci", "--ignore-scripts", "--no-audit", "--no-fund", "--fetch-retries=0"],
            cwd=folder,
            capture_output=True,
            text=True,
            timeout=240,
        )
        if any(word in done.stderr for word in _NO_REGISTRY):
            pytest.skip("npm cannot reach its registry")
        assert done.returncode == 0, done.stderr
        installed.write_text(lock)
    return command_line(["node", folder / "fit.mjs"])
