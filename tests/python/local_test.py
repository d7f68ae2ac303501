"""The calls in this process: the numbers of the program `lightfit`, and how they are stopped."""

import os
import pathlib
import signal
import subprocess
import sys
import threading
from typing import Any, List

import numpy
import pytest
from google.protobuf import json_format

import lightfit
from conftest import YARD
from lightfit.v1 import allocation_pb2, result_pb2
from readbacks import large_readback

MAP = (1024, 1024)


def fit(yard: lightfit.ExrReadback, **more: Any) -> lightfit.FitResult:
    return lightfit.fit(yard.depth, yard.shadow, yard.camera, yard.lights, MAP, **more)


def planes_of(yard: lightfit.ExrReadback) -> Any:
    return numpy.stack([(yard.shadow >> light) & 1 for light in range(3)]).astype(bool)


def test_a_fit_is_that_of_the_program(fit_by_program: Any, yard: lightfit.ExrReadback) -> None:
    want = fit_by_program(
        YARD / "0001.exr", "--lights", YARD / "scene.json", "--clip", "direct3d"
    )
    want.readback.ClearField("origin")  # arrays have none
    result = fit(yard, clip="direct3d", foretell_wrong=True, source=yard.path)
    assert result.ok
    assert result.message == want
    sun = result["sun"]
    assert sun.clip_from_world is not None
    assert sun.clip_from_world.ravel().tolist() == list(want.lights[0].clip_from_world.m)
    assert sun.foretold_wrong == want.lights[0].foretold_wrong.final
    assert sun.evaluations > 0 and sun.stop_reason == "CONVERGED"


def test_options_are_those_of_the_program(fit_by_program: Any, yard: lightfit.ExrReadback) -> None:
    want = fit_by_program(
        YARD / "0001.exr", "--lights", YARD / "scene.json", "--search", "focused",
        "--margin-percent", "3",
    )
    want.readback.ClearField("origin")
    options = {"search": "focused", "margin_percent": 3}
    assert fit(yard, options=options, foretell_wrong=True, source=yard.path).message == want


def test_shadows_may_be_bits_or_planes(yard: lightfit.ExrReadback) -> None:
    want = fit(yard).message
    planes = planes_of(yard)
    for shadow in (planes, planes.astype(numpy.uint8) * 255, numpy.asfortranarray(planes)):
        result = lightfit.fit(yard.depth, shadow, yard.camera, yard.lights, MAP)
        assert result.message == want


def test_depth_may_be_halves(yard: lightfit.ExrReadback) -> None:
    with numpy.errstate(over="ignore"):
        halves = yard.depth.astype(numpy.float16)  # background becomes infinity
    want = lightfit.fit(halves.astype(numpy.float32), yard.shadow, yard.camera, yard.lights, MAP)
    result = lightfit.fit(halves, yard.shadow, yard.camera, yard.lights, MAP)
    assert result.ok and result.message == want.message


def test_a_light_that_cannot_be_used_fails_alone(yard: lightfit.ExrReadback) -> None:
    want = fit(yard)
    lights = [*yard.lights, lightfit.Light.sun("dark", (0, 0, 0))]
    result = lightfit.fit(yard.depth, yard.shadow, yard.camera, lights, MAP)
    assert list(result.message.lights[:3]) == list(want.message.lights)
    assert result["dark"].status.code == "INVALID_ARGUMENT"
    assert "direction" in result["dark"].status.message
    with pytest.raises(lightfit.InvalidArgumentError, match='light "dark"'):
        result.raise_for_status()


def test_what_is_wrong_as_a_whole_raises(yard: lightfit.ExrReadback) -> None:
    twice = [yard.lights[0], yard.lights[0]]
    with pytest.raises(lightfit.InvalidArgumentError, match="distinct") as caught:
        lightfit.fit(yard.depth, yard.shadow, yard.camera, twice, MAP, request_id="r7")
    assert caught.value.request_id == "r7" and caught.value.code == "INVALID_ARGUMENT"
    with pytest.raises(ValueError, match="min_w"):
        fit(yard, options={"min_w": 2})
    skewed = lightfit.Camera.from_matrices(2 * numpy.eye(4), numpy.eye(4), clip="vulkan")
    with pytest.raises(ValueError, match="camera"):
        lightfit.fit(yard.depth, yard.shadow, skewed, yard.lights, MAP)
    for depth in (yard.depth[:, ::-1][:, :90], numpy.float32(yard.depth[:90])):
        with pytest.raises(ValueError, match="shadow: has shape"):
            lightfit.fit(depth, yard.shadow, yard.camera, yard.lights, MAP)


def test_threads_fit_at_the_same_time(yard: lightfit.ExrReadback) -> None:
    want = fit(yard).message
    results: List[Any] = []
    threads = [
        threading.Thread(target=lambda: results.append(fit(yard).message)) for _ in range(8)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(results) == 8 and all(result == want for result in results)


# Minutes, on a read-back of 2000 x 1500.
SLOW = {
    "search": "rotation_line_search",
    "affine": "min_area_rectangle",
    "metric": "l2",
    "sample_by_sample": True,
    "cover": "receivers",
    "line_search_rounds": 1000,
}


def test_time_limits_are_kept(yard: lightfit.ExrReadback) -> None:
    arguments = large_readback(2000, 1500)
    for timeout_s in (0.05, 0.5):
        with pytest.raises(lightfit.DeadlineError, match=f"timeout_s = {timeout_s}") as caught:
            lightfit.fit(*arguments, MAP, options=SLOW, timeout_s=timeout_s)
    assert isinstance(caught.value, TimeoutError)
    assert fit(yard, timeout_s=600).ok


def test_control_c_stops_the_search(yard: lightfit.ExrReadback) -> None:
    arguments = large_readback(2000, 1500)
    threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT)).start()
    with pytest.raises(KeyboardInterrupt):
        lightfit.fit(*arguments, MAP, options=SLOW)
    assert fit(yard).ok


def test_other_threads_run_during_a_search() -> None:
    ticks: List[int] = []
    done = threading.Event()

    def tick() -> None:
        while not done.wait(0.005):
            ticks.append(1)

    thread = threading.Thread(target=tick)
    thread.start()
    try:
        with pytest.raises(lightfit.DeadlineError):
            lightfit.fit(*large_readback(2000, 1500), MAP, options=SLOW, timeout_s=0.5)
    finally:
        done.set()
        thread.join()
    assert len(ticks) > 5


def test_a_track_keeps_what_is_good_enough(yard: lightfit.ExrReadback) -> None:
    arguments = (yard.depth, yard.shadow, yard.camera, yard.lights)
    with lightfit.track(MAP, stability=1.0) as track:
        first = track.update(1, *arguments)
        state = track.state
        again = track.update(2, *arguments)
        assert [light.action for light in first.lights] == ["FIRST"] * 3
        assert [light.action for light in again.lights] == ["KEPT"] * 3
        assert again.message.shot.number == 2
        with pytest.raises(lightfit.InvalidArgumentError, match="distinct"):
            track.update(3, *arguments[:3], [yard.lights[0]] * 2)
        with pytest.raises(ValueError, match="shadow"):
            track.update(3, yard.depth, yard.shadow[:9], *arguments[2:])
        third = track.update(3, *arguments)
    with pytest.raises(lightfit.CancelledError, match="closed"):
        track.update(4, *arguments)
    with lightfit.track(MAP, stability=1.0, state=state) as resumed:
        assert resumed.update(2, *arguments).message == again.message
        assert resumed.update(3, *arguments).message == third.message


def test_a_track_says_what_is_wrong_with_its_setup() -> None:
    with pytest.raises(ValueError, match="stability = 2"):
        lightfit.track(MAP, stability=2)
    with pytest.raises(ValueError, match="stability or tracker"):
        lightfit.track(MAP, stability=0.5, tracker=lightfit.TrackerSettings())


def test_evaluate_gives_a_fit_its_own_figures(yard: lightfit.ExrReadback) -> None:
    fitted = fit(yard, clip="opengl", foretell_wrong=True)
    candidates: List[lightfit.Candidate] = []
    for light in fitted.lights:
        assert light.map_from_world is not None and light.clip_from_world is not None
        candidates += [
            lightfit.Candidate.map(light.name, light.map_from_world, MAP),
            lightfit.Candidate.clip(light.name, light.clip_from_world, MAP, clip="opengl"),
        ]
    candidates.append(lightfit.Candidate.map("moon", numpy.eye(4), MAP))
    result = lightfit.evaluate(yard.depth, yard.shadow, yard.camera, yard.lights, candidates)
    assert len(result.evaluations) == 7
    for light, (exact, rounded) in zip(
        fitted.lights, zip(result.evaluations[0:6:2], result.evaluations[1:6:2])
    ):
        assert exact.light == rounded.light == light.name
        assert exact.energy == pytest.approx(light.energy, rel=1e-9)
        assert rounded.energy == pytest.approx(light.energy, rel=1e-9)
        assert exact.wrong_share == light.foretold_wrong
        assert exact.num_behind == 0
    assert not result.evaluations[6].ok and "moon" in str(result.evaluations[6].status)
    with pytest.raises(ValueError, match=r"matrices\[0\]: is a ndarray, want lightfit.Candidate"):
        matrices: Any = [numpy.eye(4)]
        lightfit.evaluate(yard.depth, yard.shadow, yard.camera, yard.lights, matrices)


def test_an_allocation_is_that_of_the_program(
    tmp_path: pathlib.Path, run_lightfit: Any, yard: lightfit.ExrReadback
) -> None:
    path = tmp_path / "allocation.json"
    done = run_lightfit(
        "allocate", YARD / "0001.exr", "--lights", YARD / "scene.json",
        "--budget", str(3 << 20), "--json", path,
    )
    assert path.exists(), done.stderr
    want = json_format.Parse(path.read_text(), allocation_pb2.Allocation())
    result = lightfit.allocate(
        yard.depth, yard.shadow, yard.camera, yard.lights,
        budget_texels=3 << 20, source=yard.path,
    )
    assert result.message == want
    assert sum(w * h for w, h in result.map_sizes.values()) == result.texels <= 3 << 20
    reached = lightfit.allocate(
        yard.depth, yard.shadow, yard.camera, yard.lights, tolerance=lightfit.Tolerance(2.0, 4.0)
    )
    assert all(found.reached.is_met for found in reached.message.maps)
    with pytest.raises(ValueError, match="either budget_texels"):
        lightfit.allocate(yard.depth, yard.shadow, yard.camera, yard.lights)
    with pytest.raises(ValueError, match="lights: 0 of them"):
        lightfit.allocate(yard.depth, budget_texels=5)


def test_a_summary_is_fitted_as_by_the_program(
    tmp_path: pathlib.Path, run_lightfit: Any
) -> None:
    summary, path = tmp_path / "shot.summary", tmp_path / "shot.json"
    made = run_lightfit(
        "summarize", YARD / "0001.exr", "--lights", YARD / "scene.json", "--output", summary
    )
    assert summary.exists(), made.stderr
    run_lightfit("fit", "--summary", summary, "--map", "1024x1024", "--json", path)
    want = json_format.Parse(path.read_text(), result_pb2.FitResult())
    for form in ([summary], [str(summary)], [summary.read_bytes()]):
        message = lightfit.fit_summary(form, MAP).message
        message.readback.source = want.readback.source
        assert message == want
    assert lightfit.allocate(summaries=[summary], budget_texels=1 << 20).texels <= 1 << 20
    with pytest.raises(ValueError, match="is one summary, want a list"):
        lightfit.fit_summary(summary, MAP)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="absent.summary: No such file"):
        lightfit.fit_summary(["absent.summary"], MAP)
    with pytest.raises(lightfit.InvalidArgumentError):
        lightfit.fit_summary([summary.read_bytes()[:-3]], MAP)


def test_the_package_needs_grpc_for_clients_only() -> None:
    done = subprocess.run(
        [sys.executable, "-c", "import lightfit, sys; assert 'grpc' not in sys.modules"],
        capture_output=True, text=True,
    )
    assert done.returncode == 0, done.stderr


def test_the_version_is_that_of_the_program(run_lightfit: Any) -> None:
    assert lightfit.__version__ in run_lightfit("--version").stdout
