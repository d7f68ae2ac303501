"""Summaries and comparisons of arrays: what the command line has for the same read-back."""

from __future__ import annotations

import pathlib
from typing import Any

import numpy
import pytest
from google.protobuf import json_format

import lightfit
from conftest import YARD
from lightfit.v1 import comparison_pb2, result_pb2, summary_pb2
from readbacks import large_readback

MAP = (1024, 1024)
EXR, LIGHTS = YARD / "0001.exr", YARD / "scene.json"


@pytest.fixture(params=["in this process", "through a server"])
def calls(request: Any) -> Any:
    return lightfit if request.param == "in this process" else request.getfixturevalue("client")


@pytest.fixture
def arguments(yard: lightfit.ExrReadback) -> Any:
    return yard.depth, yard.shadow, yard.camera, yard.lights


def summary_file(path: pathlib.Path) -> summary_pb2.SummaryFile:
    """Behind its 20 bytes of header."""
    return summary_pb2.SummaryFile.FromString(path.read_bytes()[20:])


@pytest.mark.parametrize("metric", ["l2", "l1-edge"])
def test_a_summary_is_that_of_the_program(
    calls: Any, arguments: Any, tmp_path: pathlib.Path, run_lightfit: Any, metric: str
) -> None:
    path = tmp_path / "yard.summary"
    done = run_lightfit("summarize", EXR, "--lights", LIGHTS, "--metric", metric, "-o", path)
    assert done.returncode == 0, done.stderr
    want = summary_file(path)
    options = {"metric": metric}
    for summary in (
        calls.summarize(*arguments, options=options, source="0001.exr"),
        calls.summarize_exr(EXR, LIGHTS, options=options),
    ):
        assert summary.message.lights == want.lights
        assert summary.message.options == want.options
        assert summary.message.writer == want.writer
    assert set(summary.lights) == {"sun", "key", "rim"}
    assert summary.lights["sun"].frames == 1 and summary.lights["sun"].samples > 100


def test_a_saved_summary_is_one_for_the_program(
    arguments: Any, tmp_path: pathlib.Path, run_lightfit: Any
) -> None:
    summary = lightfit.summarize(*arguments)
    summary.save(tmp_path / "a.summary")
    assert (tmp_path / "a.summary").read_bytes() == summary.data
    assert [path.name for path in tmp_path.iterdir()] == ["a.summary"]
    out = tmp_path / "fit.json"
    done = run_lightfit("fit", "--summary", tmp_path / "a.summary", "--map", "1024x1024",
                        "--json", out, "--quiet")
    assert done.returncode == 0, done.stderr
    by_program = json_format.Parse(out.read_text(), result_pb2.FitResult())
    ours = lightfit.fit_summary([summary], MAP)
    for light, wanted in zip(ours.lights, by_program.lights):
        assert light.message.map_from_world == wanted.map_from_world
    with pytest.raises(ValueError, match="absent/a.summary: No such file"):
        summary.save(tmp_path / "absent" / "a.summary")


def test_summaries_add_up_in_any_order(calls: Any) -> None:
    frames = [large_readback(width, 64) for width in (96, 112, 128)]
    parts = [calls.summarize(*frame) for frame in frames]
    total = calls.summarize(summaries=parts)
    assert calls.summarize(summaries=parts[::-1]).data == total.data
    assert calls.summarize(*frames[0], summaries=[parts[2].data, parts[1].message]).data == total.data
    assert {light.frames for light in total.lights.values()} == {3}
    want = lightfit.fit_summary(parts, MAP)
    assert calls.fit_summary([total], MAP).message == want.message
    assert calls.allocate(summaries=[total], budget_texels="1024x1024").ok


def test_samples_may_be_weighed_by_given_maps(calls: Any, arguments: Any, tmp_path: Any,
                                              run_lightfit: Any) -> None:
    options = {"metric": "l1"}
    first = calls.fit(*arguments, MAP, options=options)
    result, path = tmp_path / "first.json", tmp_path / "second.summary"
    result.write_text(json_format.MessageToJson(first.message))
    done = run_lightfit("summarize", EXR, "--lights", LIGHTS, "--metric", "l1", "--weigh-by", result,
                        "-o", path)
    assert done.returncode == 0, done.stderr
    summary = calls.summarize(*arguments, options=options, weigh_by=first)
    assert summary.message.lights == summary_file(path).lights
    alone = [lightfit.Candidate.map("sun", first["sun"].map_from_world, MAP)]
    partly = calls.summarize(*arguments, options=options, weigh_by=alone)
    assert partly.lights["sun"].frames == 1
    assert (partly.lights["key"].frames, partly.lights["key"].frames_without) == (0, 1)
    assert "weigh_by has no matrix of this light" in partly.lights["key"].reason
    with pytest.raises(ValueError, match="weigh_by: is for METRIC_L1"):
        calls.summarize(*arguments, options={"metric": "l2"}, weigh_by=first)


def test_a_light_that_shows_nothing_is_counted(calls: Any, arguments: Any) -> None:
    depth, shadow, camera, lights = arguments
    summary = calls.summarize(depth, shadow & numpy.uint32(0xFFFFFFFD), camera, lights, source="bare")
    key = summary.lights["key"]
    assert (key.frames, key.samples) in ((0, 0), (1, 0))
    if key.frames == 0:
        assert key.frames_without == 1 and "bare" in key.reason


def test_a_frame_is_not_counted_twice(calls: Any) -> None:
    frame = large_readback(96, 64)
    numbered = [calls.summarize(*frame, number=number) for number in (1001, 1002)]  # a still shot
    assert calls.summarize(summaries=numbered).lights["sun"].frames == 2
    with pytest.raises(ValueError, match="frame 1001 is in .* and would count twice"):
        calls.summarize(summaries=[*numbered, numbered[0]])
    with pytest.raises(ValueError, match="a frame without a number"):
        calls.summarize(summaries=[calls.summarize(*frame)] * 2)


def test_a_finite_sky_is_said_to_be_taken_for_background(calls: Any, arguments: Any) -> None:
    depth, shadow, camera, lights = arguments
    sky = numpy.where(depth > 1e9, numpy.float32(65504), depth)
    want = calls.summarize(*arguments).message.lights
    with pytest.warns(lightfit.LightfitWarning, match="65504"):
        assert calls.summarize(sky, shadow, camera, lights).message.lights == want
    assert calls.summarize(sky, shadow, camera, lights, background=65504).message.lights == want
    plain = calls.compare(*arguments, MAP)
    with pytest.warns(lightfit.LightfitWarning, match="65504"):
        found = calls.compare(sky, shadow, camera, lights, MAP)
    assert found.message.lights == plain.message.lights


@pytest.mark.parametrize("arguments_", [{}, {"summaries": ()}])
def test_nothing_to_summarize_is_refused(calls: Any, arguments_: Any) -> None:
    with pytest.raises(ValueError, match="readback: none, and no summaries either"):
        calls.summarize(**arguments_)


def test_wrong_summaries_are_named(calls: Any, arguments: Any) -> None:
    with pytest.raises(ValueError, match=r"summary_files\[0\]: is no summary file"):
        calls.summarize(*arguments, summaries=[b"no summary, but long enough for one"])
    with pytest.raises(ValueError, match=r"want a list of them: \[summary\]"):
        calls.summarize(*arguments, summaries="one.summary")
    with pytest.raises(ValueError, match=r"summaries\[0\]: is a int, want the result of"):
        calls.summarize(*arguments, summaries=[3])
    with pytest.raises(ValueError, match="other.summary: No such file"):
        calls.summarize(*arguments, summaries=["other.summary"])


def test_lights_without_a_channel_are_refused(calls: Any) -> None:
    lights = [*lightfit.read_exr(EXR, LIGHTS).lights, lightfit.Light.sun("moon", (0, 0, -1))]
    for call in (lambda: calls.summarize_exr(EXR, lights),
                 lambda: calls.compare_exr(EXR, lights, MAP)):
        with pytest.raises(lightfit.LightfitError, match='moon.*leave "moon" out of lights'):
            call()


def test_a_comparison_is_that_of_the_program(
    calls: Any, arguments: Any, tmp_path: pathlib.Path, run_lightfit: Any
) -> None:
    path = tmp_path / "compare.json"
    mine = calls.fit(*arguments, (512, 512), options={"search": "focused"})
    (tmp_path / "mine.json").write_text(json_format.MessageToJson(mine.message))
    done = run_lightfit("compare", EXR, "--lights", LIGHTS, "--map", "1024x1024", "--border", "lit",
                        "--matrix", f"mine={tmp_path / 'mine.json'}", "--json", path, "--quiet")
    assert done.returncode == 0, done.stderr
    want = json_format.Parse(path.read_text(), comparison_pb2.Comparison())
    for comparison in (
        calls.compare(*arguments, MAP, given={"mine": mine}, source=str(EXR)),
        calls.compare_exr(EXR, LIGHTS, MAP, given={"mine": mine}),
    ):
        assert comparison.message == want
    sun = comparison["sun"]
    assert sun.methods[-1] is sun["lightfit"] and sun["lightfit"].energy_ratio == 1.0
    assert sun["focused"].energy_ratio > sun["mine"].energy_ratio > 1.0
    assert comparison.totals["focused"].lights == 3
    assert 0 < sun["lightfit"].foretold_wrong < sun["standard"].foretold_wrong < 1
    table = str(comparison).splitlines()
    assert len(table) == sum(len(light.methods) for light in comparison.lights)
    assert table[-1].split()[:3] == ["rim", "lightfit", "1x"]


def test_matrices_to_compare_may_be_given_one_by_one(calls: Any, arguments: Any) -> None:
    sun = calls.fit(*arguments, MAP, clip="opengl")["sun"]
    candidates = [lightfit.Candidate.clip("sun", sun.clip_from_world, MAP, clip="opengl")]
    comparison = calls.compare(*arguments, MAP, given={"engine": candidates})
    assert comparison["sun"]["engine"].energy_ratio == pytest.approx(1.0, rel=1e-9)
    assert comparison["key"]["engine"].status.code == "NOT_FOUND"
    assert comparison["key"]["engine"].energy is None
    with pytest.raises(ValueError, match=r"given\['engine'\]\[0\]: is a int"):
        calls.compare(*arguments, MAP, given={"engine": [3]})
    with pytest.raises(ValueError, match=r"given\[0\]: name: is empty"):
        calls.compare(*arguments, MAP, given={"": candidates})


def test_a_light_that_cannot_be_used_fails_alone(calls: Any, arguments: Any) -> None:
    depth, shadow, camera, lights = arguments
    spoiled = [lights[0], lightfit.Light.sun("key", (0, 0, 0)), lights[2]]
    comparison = calls.compare(depth, shadow, camera, spoiled, MAP)
    assert {method.status.code for method in comparison["key"].methods} == {"INVALID_ARGUMENT"}
    assert comparison["sun"]["lightfit"].ok
