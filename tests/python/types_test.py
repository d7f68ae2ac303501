"""The package is typed, as py.typed says: mypy --strict is content."""

import os
import subprocess
import sys

import pytest

import lightfit
from conftest import REPOSITORY


def test_types_hold(tmp_path: object) -> None:
    pytest.importorskip("mypy", reason="mypy is absent: install python3-mypy")
    package = os.path.dirname(lightfit.__file__)
    done = subprocess.run(
        [sys.executable, "-m", "mypy", "--config-file", str(REPOSITORY / "python/pyproject.toml"),
         "--cache-dir", str(tmp_path)],
        cwd=os.path.dirname(package), capture_output=True, text=True,
    )
    assert done.returncode == 0, done.stdout + done.stderr
