"""Shots of arrays and files, against what `lightfit shot` writes for the same frames."""

from __future__ import annotations

import dataclasses
import pathlib
import subprocess
from typing import Any, Dict, List, Optional, Tuple

import numpy
import pytest
from google.protobuf import json_format

import lightfit
from lightfit.shots import _number_of
from lightfit.v1 import result_pb2
from readbacks import large_readback
from serving import program

MAP = (300, 200)
NUM_FRAMES = 4


@dataclasses.dataclass
class Walk:
    """A camera that walks past boxes, and what the program makes of it."""

    paths: List[pathlib.Path]
    lights: pathlib.Path
    results: pathlib.Path

    def frames(self) -> lightfit.ExrFrames:
        return lightfit.ExrFrames(self.paths, self.lights)

    def result(self, mode: str, index: Optional[int]) -> result_pb2.FitResult:
        name = f"{self.paths[index].stem}.json" if index is not None else f"{mode}.json"
        folder = self.results / mode if index is not None else self.results
        return json_format.Parse((folder / name).read_text(), result_pb2.FitResult())


@pytest.fixture(scope="module", params=["l1-edge", "l2"])
def walk(request: Any, tmp_path_factory: pytest.TempPathFactory) -> Tuple[str, Walk]:
    pytest.importorskip("lightfit._native")
    folder = tmp_path_factory.mktemp("walk")
    paths, lights = [], folder / "lights.json"
    for index in range(NUM_FRAMES):
        paths.append(folder / f"walk.{998 + index:04d}.exr")
        run("render", "generate:objects=10,triangles=3000", "--camera",
            f"{0.1 * index},1.7,{18 - 0.3 * index}:0,0.5,0", "--light", "low=sun:1,-0.6,0.3",
            "--light", "lamp=point:-4,6,5", "--size", "96x64", "-o", paths[-1],
            "--lights-out", lights, "--quiet")
    results = folder / "out"
    run("shot", *paths, "--lights", lights, "--map", "300x200", "--metric", request.param,
        "--border", "lit", "-o", results, "--quiet")
    return request.param, Walk(paths, lights, results)


def run(*arguments: Any) -> None:
    done = subprocess.run([program(), *map(str, arguments)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


@pytest.fixture(params=["in this process", "through a server"])
def calls(request: Any) -> Any:
    return lightfit if request.param == "in this process" else request.getfixturevalue("client")


def without_names(message: result_pb2.FitResult, mode: str) -> result_pb2.FitResult:
    """What arrays cannot know: where the frame came from, and which run of the program it was."""
    copy = result_pb2.FitResult()
    copy.CopyFrom(message)
    copy.readback.ClearField("origin")
    copy.shot.ClearField("frame")
    copy.shot.ClearField("key")
    for light in copy.lights:
        if mode == "per-shot":  # of the summaries, which do not say
            light.ClearField("facing")
    return copy


def test_every_frame_is_that_of_the_program(calls: Any, walk: Tuple[str, Walk]) -> None:
    metric, files = walk
    found: Dict[Tuple[str, Optional[int]], lightfit.FitResult] = {}
    order = []
    for step in calls.shot(files.frames(), None, MAP, options={"metric": metric}):
        found[step.mode, step.index] = step.result
        order.append((step.mode, step.frame))
    numbers = [998 + index for index in range(NUM_FRAMES)]
    assert order == [
        *((mode, number) for number in numbers for mode in ("per-frame", "tracked")),
        ("per-shot", None),
        *(("per-shot", number) for number in numbers),
    ]
    for (mode, index), result in found.items():
        want = files.result(mode, index)
        for light, wanted in zip(result.lights, want.lights):
            assert light.name == wanted.name and light.ok
            assert light.message.map_from_world == wanted.map_from_world, (mode, index)
            assert light.message.clip_from_world == wanted.clip_from_world
            assert light.energy == wanted.energies.final
            if index is None:
                continue
            assert light.message.footprint == wanted.footprint
            assert light.message.samples == wanted.samples
            assert light.message.foretold_wrong.final == wanted.foretold_wrong.final
            assert light.message.shot == wanted.shot
            assert light.message.shot.HasField("crawl") == (index > 0)
        if index is not None:
            assert without_names(result.message, mode) == without_names(want, mode)


def test_arrays_give_what_files_give(walk: Tuple[str, Walk]) -> None:
    _, files = walk
    readbacks = list(files.frames())
    frames = [
        lightfit.Frame(frame.depth, frame.shadow, frame.camera, number=998 + index,
                       facing=frame.facing, mapped=frame.mapped, source=frame.path)
        for index, frame in enumerate(readbacks)
    ]
    of_files = lightfit.shot(files.frames(), None, MAP)
    of_arrays = lightfit.shot(frames, readbacks[0].lights, MAP)
    for one, other in zip(of_files, of_arrays):
        assert one.result.message == other.result.message
        assert (one.mode, one.frame, one.index) == (other.mode, other.frame, other.index)


def few_frames(count: int = 3) -> Any:
    """Fields of Frame, and the lights."""
    readbacks = [large_readback(96 + 16 * index, 64) for index in range(count)]
    return [lightfit.Frame(*readback[:3]) for readback in readbacks], readbacks[0][3]


def test_frames_are_looked_at_when_their_turn_comes() -> None:
    frames, lights = few_frames()
    seen = []

    def one_by_one() -> Any:
        for index, frame in enumerate(frames):
            seen.append(index)
            yield frame

    steps = lightfit.shot(one_by_one(), lights, MAP, modes=("tracked", "per-frame"))
    assert seen == []
    assert (next(steps).frame, seen) == (1, [0])
    assert (next(steps).mode, seen) == ("tracked", [0])
    assert (next(steps).frame, seen) == (2, [0, 1])
    steps.close()  # type: ignore[attr-defined]


def test_modes_may_be_chosen() -> None:
    frames, lights = few_frames()
    assert [step.mode for step in lightfit.shot(frames, lights, MAP, modes="tracked")] == [
        "tracked"] * 3
    steps = list(lightfit.shot(frames, lights, MAP, modes=["PER_SHOT"], rounds=0))
    assert [step.frame for step in steps] == [None, 1, 2, 3]
    whole = lightfit.fit_summary([lightfit.summarize(f.depth, f.shadow, f.camera, lights)
                                  for f in frames], MAP)
    for light in steps[0].result.lights:
        assert numpy.array_equal(light.map_from_world, whole[light.name].map_from_world)


def test_no_crawl_is_measured_over_missing_frames() -> None:
    frames, lights = few_frames()
    numbered = [dataclasses.replace(frame, number=number)
                for frame, number in zip(frames, (-3, -1, 5))]
    for step, have_crawl in ((1, [False] * 3), (2, [False, True, False]), (6, [False, True, True])):
        for mode in ("per-frame", "tracked", "per-shot"):
            found = [s for s in lightfit.shot(numbered, lights, MAP, modes=mode, step=step)
                     if s.frame is not None]
            assert [s.frame for s in found] == [-3, -1, 5]
            assert [s.result["sun"].message.shot.HasField("crawl") for s in found] == have_crawl


@pytest.mark.parametrize(
    "name, number",
    [("0001.exr", 1), ("walk.1001.exr", 1001), ("walk-0007.exr", 7), ("walk.-003.exr", -3),
     ("-12.exr", -12), ("beauty.exr", None), ("shot_v2.exr", 2)],
)
def test_files_tell_their_number(name: str, number: Optional[int]) -> None:
    assert _number_of(f"/shots/a1/{name}") == number


def test_a_light_may_move_where_no_map_is_for_all_frames() -> None:
    frames, lights = few_frames()
    moved = [
        dataclasses.replace(frame, lights=[lights[0], lights[1],
                                           lightfit.Light.point("rim", (-2 - 0.1 * index, -4, 12))])
        for index, frame in enumerate(frames)
    ]
    for step in lightfit.shot(moved, None, MAP, modes=("per-frame", "tracked")):
        assert step.result["rim"].ok
    with pytest.raises(ValueError, match="rim"):
        list(lightfit.shot(moved, None, MAP, modes=("per-shot",)))


def test_wrong_frames_are_named() -> None:
    frames, lights = few_frames()
    wrong = [frames[0], dataclasses.replace(frames[1], shadow=frames[0].shadow)]
    steps = lightfit.shot(wrong, lights, MAP, modes="per-frame")
    assert next(steps).frame == 1
    with pytest.raises(ValueError, match=r"frames\[1\]: shadow: has shape"):
        next(steps)
    for bad, words in (
        (iter(frames), "is an iterator, which ends after one round"),
        (frames[0], r"is one frame, want a list of them: \[frame\]"),
        (3, "frames: is a int"),
    ):
        with pytest.raises(ValueError, match=words):
            lightfit.shot(bad, lights, MAP)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match=r"frames\[0\]: is a int, want lightfit.Frame"):
        list(lightfit.shot([3], lights, MAP))  # type: ignore[list-item]
    with pytest.raises(ValueError, match=r"frames\[0\]: lights: none"):
        list(lightfit.shot(frames, None, MAP))
    with pytest.raises(ValueError, match="modes = 'per-frames', want one of per-frame, tracked"):
        lightfit.shot(frames, lights, MAP, modes=("per-frames",))
    backwards = [dataclasses.replace(frame, number=7) for frame in frames]
    with pytest.raises(ValueError, match=r"frames\[1\]: number = 7 after 7, want them in order"):
        list(lightfit.shot(backwards, lights, MAP))
