"""The examples of python/README.md run as they stand."""

from __future__ import annotations

import json
import pathlib
import re
import shutil
from typing import Any, Dict, List

import numpy
import pytest

import lightfit
from conftest import REPOSITORY, YARD
from serving import Server


def blocks() -> List[str]:
    text = (REPOSITORY / "python" / "README.md").read_text()
    return re.findall(r"^```python\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)


def test_the_examples_run(
    yard: lightfit.ExrReadback, server: Server, tmp_path: pathlib.Path,
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str],
) -> None:
    for name in ("0001.exr", "scene.json"):
        shutil.copy(YARD / name, tmp_path)
    monkeypatch.chdir(tmp_path)
    scene = json.loads((tmp_path / "scene.json").read_text())["frames"][0]
    names: Dict[str, Any] = {
        "depth": yard.depth,
        "shadow": yard.shadow,
        "camera": yard.camera,
        "lights": yard.lights,
        "camera_from_world": numpy.linalg.inv(numpy.array(scene["camera_to_world"])),
        "clip_from_camera": numpy.array(scene["projection"]),
        "points": numpy.zeros((5, 3)),
    }
    found = blocks()
    assert len(found) >= 5
    for number, block in enumerate(found):
        code = block.replace("127.0.0.1:50071", server.address)
        exec(compile(code, f"README.md, example {number + 1}", "exec"), names)
    assert names["result"].message.ByteSize() > 0
    said = capsys.readouterr().out
    for words in ("per-frame 1", "tracked 1", "per-shot None", "lightfit", "lispsm"):
        assert words in said
