"""`pip install ./python`, as README.md has it and without a network, gives a package that stands by
itself."""

import importlib.util
import os
import pathlib
import re
import shutil
import subprocess
import sys
from typing import Any, Callable, Dict

import pytest

import lightfit
from conftest import REPOSITORY, YARD

FIT = f"""
import lightfit, sys
assert lightfit.__file__.startswith(sys.prefix), lightfit.__file__
assert lightfit.__version__ == {lightfit.__version__!r}
result = lightfit.fit_exr({str(YARD / "0001.exr")!r}, {str(YARD / "scene.json")!r}, (512, 512))
assert result.ok
lightfit.Client().close()
"""

Run = Callable[..., "subprocess.CompletedProcess[str]"]


@pytest.fixture
def environment() -> Dict[str, str]:
    for module in ("pip", "venv", "ensurepip"):
        if importlib.util.find_spec(module) is None:
            pytest.skip(f"{module} is absent: install python3-{module.replace('ensurepip', 'venv')}")
    kept = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    build = os.environ.get("LIGHTFIT_BUILD_DIR", str(REPOSITORY / "build/release"))
    return {**kept, "LIGHTFIT_BUILD_DIR": build, "PIP_NO_INDEX": "1"}


@pytest.fixture
def run(tmp_path: pathlib.Path, environment: Dict[str, str]) -> Run:
    """In a folder that has python/ as the repository does."""
    (tmp_path / "python").symlink_to(REPOSITORY / "python")

    def in_folder(*command: Any, **more: str) -> "subprocess.CompletedProcess[str]":
        return subprocess.run(
            [str(word) for word in command], env={**environment, **more}, cwd=tmp_path,
            capture_output=True, text=True,
        )

    return in_folder


def succeeded(done: "subprocess.CompletedProcess[str]") -> str:
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_the_commands_of_the_readme_install_the_package(run: Run, tmp_path: pathlib.Path) -> None:
    readme = (REPOSITORY / "python" / "README.md").read_text()
    commands = re.findall(r"^    ((?:/usr/bin/python3 -m venv|venv/bin/pip) .*?)(?:  #.*)?$",
                          readme, re.MULTILINE)
    assert len(commands) == 2
    for command in commands:
        words = [sys.executable if word == "/usr/bin/python3" else word for word in command.split()]
        succeeded(run(*words))
    succeeded(run(tmp_path / "venv/bin/python", "-c", FIT))
    metadata = succeeded(run(tmp_path / "venv/bin/pip", "show", "--files", "lightfit"))
    assert f"Version: {lightfit.__version__}" in metadata
    assert "lightfit/py.typed" in metadata and "lightfit/v1/service_pb2.pyi" in metadata
    succeeded(run(tmp_path / "venv/bin/pip", "uninstall", "--yes", "lightfit"))


def test_an_editable_installation_is_the_build_itself(run: Run, tmp_path: pathlib.Path) -> None:
    succeeded(run(sys.executable, "-m", "venv", "--system-site-packages", "venv"))
    succeeded(run(tmp_path / "venv/bin/pip", "install", "-e", "./python"))
    found = succeeded(run(tmp_path / "venv/bin/python", "-c",
                          "import lightfit; print(lightfit.__file__)"))
    assert pathlib.Path(found.strip()).parent == pathlib.Path(lightfit.__file__).parent


@pytest.mark.parametrize("missing", ["_native*", "v1/service_pb2.py"])
def test_a_build_that_lacks_something_is_named(
    run: Run, tmp_path: pathlib.Path, missing: str
) -> None:
    build = tmp_path / "build"
    shutil.copytree(pathlib.Path(lightfit.__file__).parent, build / "python" / "lightfit")
    for path in (build / "python" / "lightfit").glob(missing):
        path.unlink()
    done = run(sys.executable, "-m", "pip", "wheel", "--no-deps", "./python",
               LIGHTFIT_BUILD_DIR=str(build))
    assert done.returncode != 0
    assert "is absent: cmake --build" in done.stdout + done.stderr


def test_a_compiled_part_of_another_python_is_refused(run: Run, tmp_path: pathlib.Path) -> None:
    build = tmp_path / "build"
    package = build / "python" / "lightfit"
    shutil.copytree(pathlib.Path(lightfit.__file__).parent, package)
    next(package.glob("_native*.so")).rename(package / "_native.cpython-38-x86_64-linux-gnu.so")
    done = run(sys.executable, "-m", "pip", "wheel", "--no-deps", "./python",
               LIGHTFIT_BUILD_DIR=str(build))
    assert done.returncode != 0
    assert "is not for this Python" in done.stdout + done.stderr
