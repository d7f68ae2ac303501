"""Several maps for one light: here, by the program, and by a server."""

import pathlib
import re
from typing import Any, Callable, Dict, Tuple

import numpy
import pytest
from google.protobuf import json_format

import lightfit
from conftest import ROOM, YARD, without_yardsticks
from lightfit.v1 import allocation_pb2, result_pb2, shot_pb2
from readbacks import large_readback
from serving import REPOSITORY, Server

PLAN: Dict[str, Any] = {"max_maps": 3, "texels": 90000}


@pytest.fixture
def arguments(yard: lightfit.ExrReadback) -> Any:
    return yard.depth, yard.shadow, yard.camera, yard.lights


@pytest.fixture
def plans_by_program(
    tmp_path: pathlib.Path, run_lightfit: Any
) -> Callable[..., result_pb2.FitResult]:
    """What `lightfit fit --maps` writes, without the yardsticks."""

    def fit(*arguments: Any) -> result_pb2.FitResult:
        path = tmp_path / "plan.json"
        run_lightfit("fit", *arguments, "--border", "lit", "--json", path, "--quiet")
        result = json_format.Parse(path.read_text(), result_pb2.FitResult())
        for light in result.lights:
            without_yardsticks(light)
            for field in ("one_map", "final_over_one_map"):
                light.energies.ClearField(field)
            light.foretold_wrong.ClearField("one_map")
        return result

    return fit


def floor() -> Tuple[Any, Any, Any, Any, Any]:
    """A read-back and the world point of each pixel's centre."""
    depth, shadow, camera, lights = large_readback(240, 160)
    x = (numpy.arange(240) + 0.5 - 120) / camera.intrinsics.fx
    y = (numpy.arange(160) + 0.5 - 160 / 3) / camera.intrinsics.fy
    rays = numpy.stack(numpy.broadcast_arrays(x[None], y[:, None], 1.0), axis=-1)
    return depth, shadow, camera, lights, rays * depth[..., None].astype(numpy.float64)


@pytest.mark.parametrize("example", [YARD, ROOM])
def test_plans_are_those_of_the_program(plans_by_program: Any, example: pathlib.Path) -> None:
    exr, lights = example / "0001.exr", example / "scene.json"
    want = plans_by_program(exr, "--lights", lights, "--maps", 3, "--texels", 90000, "--guard", 1.5)
    plan = {**PLAN, "guard_texels": 1.5}
    result = lightfit.fit_plan_exr(exr, lights, plan, foretell_wrong=True)
    assert result.ok and result.message == want
    sun = result["sun"]
    assert sun.plan is not None and len(sun.plan.maps) == 3
    assert sun.map_from_world is None and sun.map_size == (0, 0)
    assert sun.energy == pytest.approx(sum(part.energy for part in sun.plan.maps), rel=1e-12)


def test_maps_may_have_one_size(arguments: Any) -> None:
    plan = {"max_maps": 2, "each": (128, 64)}
    result = lightfit.fit_plan(*arguments, plan, clip="opengl")
    for light in result.lights:
        assert light.plan is not None
        assert [part.map_size for part in light.plan.maps] == [(128, 64)] * 2
        assert light.plan.texels == 2 * 128 * 64 and light.plan.border == light.border == "lit"
        for index, part in enumerate(light.plan.maps):
            assert part.index == index and part.action is None and part.frames_kept is None
            assert part.clip_from_world is not None and part.map_from_world is not None
            assert part.clip_from_world.tolist() != part.map_from_world.tolist()
    message = lightfit.PlanOptions(max_maps=2)
    message.each.width, message.each.height = 128, 64
    assert lightfit.fit_plan(*arguments, message, clip="opengl").message == result.message


def test_one_map_is_the_answer_without_a_plan(arguments: Any) -> None:
    one = lightfit.fit_plan(*arguments, {"max_maps": 1, "each": (256, 128)})
    single = lightfit.fit(*arguments, (256, 128))
    for light, other in zip(one.lights, single.lights):
        assert light.plan is not None and len(light.plan.maps) == 1
        assert light.map_from_world is not None and light.evaluations == other.evaluations
        assert numpy.array_equal(light.map_from_world, other.map_from_world)
        assert other.plan is None


# The look-up here sends every sample to the map that the fit has counted it in, and every shadow to
# some map.
@pytest.mark.parametrize("guard", [0.0, 2.0])
def test_the_look_up_is_that_of_the_fit(guard: float) -> None:
    *readback, points = floor()
    depth, shadow, _, lights = readback
    plan = {"max_maps": 4, "texels": 40000, "guard_texels": guard}
    result = lightfit.fit_plan(*readback, plan)
    for bit, light in enumerate(result.lights):
        assert light.plan is not None and light.samples is not None
        is_blocked = (shadow >> bit) & 1 == 1
        asked, texels = light.plan.look_up(points)
        assert asked.shape == depth.shape and texels.shape == (*depth.shape, 2)
        assert (asked[is_blocked] >= 0).all()
        assert numpy.isnan(texels[asked < 0]).all() and (asked < 0).any()
        for part in light.plan.maps:
            inside = texels[asked == part.index]
            assert (inside >= guard).all() and (inside < numpy.array(part.map_size) - guard).all()
        edges = numpy.zeros_like(is_blocked)
        differs = is_blocked[1:] != is_blocked[:-1]
        edges[1:] |= differs
        edges[:-1] |= differs
        differs = is_blocked[:, 1:] != is_blocked[:, :-1]
        edges[:, 1:] |= differs
        edges[:, :-1] |= differs
        edges[[0, -1]] = edges[:, [0, -1]] = False  # have no neighbours to tell the surface by
        assert light.samples.used == edges.sum()
        counts = [int((asked[edges] == part.index).sum()) for part in light.plan.maps]
        assert counts == [part.samples for part in light.plan.maps] and min(counts) > 0


def test_a_lamp_among_its_receivers_has_a_plan() -> None:
    exr, lights = ROOM / "0001.exr", ROOM / "scene.json"
    options = {"cover": "receivers"}
    single = lightfit.fit_exr(exr, lights, (512, 512), options=options)
    assert single["key"].status.code == "FAILED_PRECONDITION"
    said = re.search(r"plan_options.max_maps = (\d)\) would do", single["key"].status.message)
    assert said is not None
    plan = {"max_maps": int(said[1]), "texels": 512 * 512}
    assert lightfit.fit_plan_exr(exr, lights, plan, options=options).ok


def test_a_server_gives_the_plans_of_this_process(client: Any, arguments: Any) -> None:
    want = lightfit.fit_plan(*arguments, PLAN, foretell_wrong=True)
    assert client.fit_plan(*arguments, PLAN, foretell_wrong=True).message == want.message
    large = large_readback(1500, 1001)  # is streamed
    want = lightfit.fit_plan(*large, {"max_maps": 2})
    assert want.ok and client.fit_plan(*large, {"max_maps": 2}).message == want.message


def test_a_budget_is_divided_among_plans_as_by_the_program(
    tmp_path: pathlib.Path, run_lightfit: Any, yard: lightfit.ExrReadback, client: Any,
    arguments: Any,
) -> None:
    path = tmp_path / "allocation.json"
    run_lightfit(
        "allocate", YARD / "0001.exr", "--lights", YARD / "scene.json", "--budget", "360000",
        "--maps", 3, "--guard", 1.5, "--power-of-two", "--json", path, "--quiet",
    )
    want = json_format.Parse(path.read_text(), allocation_pb2.Allocation())
    plan = {"max_maps": 3, "guard_texels": 1.5, "sizes": {"powers_of_two": True}}
    for calls in (lightfit, client):
        result = calls.allocate(
            *arguments, budget_texels=360000, plan=plan, source=yard.path
        )
        assert result.ok and result.message == want
    plans = [light.plan for light in result.lights]
    assert sum(part.texels for part in plans) == result.texels <= 360000
    assert all(side & (side - 1) == 0 for part in plans[0].maps for side in part.map_size)
    defaults = lightfit.allocate(*arguments, budget_texels=360000, plan={})
    assert defaults.message.plan_options.max_maps == 4
    with pytest.raises(lightfit.InvalidArgumentError, match="plan_options: plans divide a budget"):
        lightfit.allocate(*arguments, tolerance=lightfit.Tolerance(2.0), plan=plan)


def test_each_map_of_a_tracked_plan_is_kept_by_itself(client: Any, arguments: Any) -> None:
    settings = lightfit.PlanTrackerSettings(
        tolerance=0.5, update_every_frames=3, cover_margin_percent=2.5
    )
    with lightfit.track_plan(PLAN, tracker=settings) as here, client.track_plan(PLAN) as there:
        for number in range(3):
            shadow = numpy.roll(arguments[1], number, axis=1)
            result = here.update(number, arguments[0], shadow, *arguments[2:])
            answer = there.update(number, arguments[0], shadow, *arguments[2:])
            assert answer.message == result.message
            plan = result["sun"].plan
            assert plan is not None and plan.is_new == (number == 0)
            assert result["sun"].action is None and result["sun"].frames_kept is None
            kept = [part.frames_kept for part in plan.maps]
            assert (number == 0) == all(part.action == "FIRST" for part in plan.maps)
            assert number == 0 or any(kept)
        state = here.state
        after = here.update(3, *arguments)
    with lightfit.track_plan(PLAN, state=state) as again:
        assert again.update(3, *arguments).message == after.message


def test_a_tracked_plan_goes_on_at_another_server(has_serve: None, arguments: Any) -> None:
    first = Server()
    with lightfit.Client(first.address) as client, client.track_plan(PLAN) as track:
        before = track.update(1, *arguments)
        first.kill()
        second = Server(listen=first.address)
        try:
            after = track.update(2, *arguments)
        finally:
            second.stop()
    for light, other in zip(before.lights, after.lights):
        assert light.plan is not None and other.plan is not None and not other.plan.is_new
        for part, kept in zip(light.plan.maps, other.plan.maps):
            assert kept.action == "KEPT" and kept.frames_kept == 1
            assert part.map_from_world is not None and kept.map_from_world is not None
            assert numpy.array_equal(part.map_from_world[:2], kept.map_from_world[:2])


@pytest.mark.parametrize(
    "plan, words",
    [
        ({"max_maps": 33}, "plan_options.max_maps = 33, want 1 ... 32"),
        ({"texels": 10}, "plan_options.texels = 10, want"),
        ({"texels": 1000, "each": (64, 64)}, "want one of the two"),
        ({"each": 64}, "plan: each = 64"),
        ({"maps": 4}, "plan: "),
        ({"guard_texels": -1}, "plan_options.guard_texels = -1"),
        (4, "plan: is a int, want a dict"),
    ],
)
def test_what_is_wrong_with_a_plan_is_said(arguments: Any, plan: Any, words: str) -> None:
    with pytest.raises(lightfit.InvalidArgumentError, match=re.escape(words)):
        lightfit.fit_plan(*arguments, plan)


def test_searches_of_single_maps_are_refused(arguments: Any) -> None:
    with pytest.raises(lightfit.InvalidArgumentError, match="options.search = SEARCH_FOCUSED"):
        lightfit.fit_plan(*arguments, PLAN, options={"search": "focused"})
    tracker: Any = shot_pb2.TrackerSettings()
    with pytest.raises(lightfit.InvalidArgumentError, match="tracker: is for one map"):
        lightfit.track_plan(PLAN, tracker=tracker)


def test_points_are_checked(arguments: Any) -> None:
    plan = lightfit.fit_plan(*arguments, PLAN)["sun"].plan
    assert plan is not None
    with pytest.raises(lightfit.InvalidArgumentError, match="points: has shape"):
        plan.look_up([1, 2])
    asked, texels = plan.look_up([0, 0, 0])
    assert asked.shape == () and texels.shape == (2,)


def test_the_example_of_the_readme_runs(capsys: Any) -> None:
    text = (REPOSITORY / "python" / "README.md").read_text()
    (code,) = [block for block in re.findall(r"```python\n(.*?)```", text, re.S) if "plan" in block]
    depth, shadow, camera, lights, points = floor()
    names: Dict[str, Any] = {
        "lightfit": lightfit, "depth": depth, "shadow": shadow, "camera": camera,
        "lights": lights, "points": points,
    }
    exec(code, names)
    assert "sun" in capsys.readouterr().out
    assert names["index"].max() >= 1 and names["texel"].shape == (*depth.shape, 2)
