"""`pip install ./python` with a finished build gives a package that stands by itself."""

import importlib.util
import os
import pathlib
import shutil
import subprocess
import sys

import pytest

from conftest import REPOSITORY, YARD

FIT = f"""
import lightfit, sys
assert lightfit.__file__.startswith(sys.prefix), lightfit.__file__
result = lightfit.fit_exr({str(YARD / "0001.exr")!r}, {str(YARD / "scene.json")!r}, (512, 512))
assert result.ok
lightfit.Client().close()
"""


def test_pip_installs_the_package(tmp_path: pathlib.Path) -> None:
    for module in ("pip", "setuptools", "wheel", "venv", "ensurepip"):
        if importlib.util.find_spec(module) is None:
            pytest.skip(f"{module} is absent: install python3-{module.replace('ensurepip', 'venv')}")
    build = os.environ.get("LIGHTFIT_BUILD_DIR", str(REPOSITORY / "build/release"))
    source, venv = tmp_path / "python", tmp_path / "venv"
    shutil.copytree(REPOSITORY / "python", source)  # pip leaves folders where it builds
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    environment["LIGHTFIT_BUILD_DIR"] = build

    def run(*command: object) -> None:
        done = subprocess.run(
            [str(word) for word in command], env=environment, cwd=tmp_path,
            capture_output=True, text=True,
        )
        assert done.returncode == 0, done.stdout + done.stderr

    run(sys.executable, "-m", "venv", "--system-site-packages", venv)
    run(venv / "bin/python", "-m", "pip", "install", "--no-build-isolation", "--no-index", source)
    run(venv / "bin/python", "-c", FIT)
