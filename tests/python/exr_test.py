"""read_exr and fit_exr against `lightfit fit` on the same file and flags."""

import pathlib
from typing import Any

import numpy
import pytest

import lightfit
from conftest import ROOM, YARD
from lightfit.v1 import light_pb2

MAP = (1024, 1024)


def test_the_arrays_of_a_file(yard: lightfit.ExrReadback) -> None:
    assert yard.depth.shape == yard.shadow.shape == (180, 180)
    assert yard.depth.dtype == numpy.float32 and yard.shadow.dtype == numpy.uint32
    assert [light.name for light in yard.lights] == ["sun", "key", "rim"]
    assert all(status.code == 0 for status in yard.light_status)
    assert (yard.camera.message.width, yard.camera.message.height) == (180, 180)
    assert 0 < (yard.shadow & 1).mean() < 1 and yard.shadow.max() < 8
    assert numpy.median(yard.depth[yard.depth < 1e9]) > 0


def test_a_file_may_say_what_faces_its_lights(
    yard: lightfit.ExrReadback, cast: lightfit.ExrReadback
) -> None:
    assert yard.facing is None and yard.mapped is None and cast.mapped is None
    assert cast.facing is not None and len(cast.facing) == 2
    for light, plane in enumerate(cast.facing):
        assert plane is not None and plane.shape == cast.depth.shape
        assert plane.dtype == numpy.bool_ and 0 < plane.mean() < 1
        blocked = (cast.shadow >> numpy.uint32(light)) & 1 == 1
        assert blocked.any() and plane[blocked].all()  # what is blocked faces the light
        assert not plane[cast.depth > 1e9].any()


def test_facing_and_mapped_channels_may_be_named(cast: lightfit.ExrReadback) -> None:
    low = light_pb2.Light(name="low", direction=cast.lights[0].direction)
    moon = light_pb2.Light(name="moon", direction=cast.lights[0].direction)
    named = lightfit.read_exr(
        cast.path, [moon, low], facing_channel="shadow.{light}", mapped_channel="facing.{light}"
    )
    assert named.facing is not None and named.mapped is not None
    assert named.facing[0] is None and named.mapped[0] is None
    assert named.light_status[0].code != 0  # it has no shadow either
    assert cast.facing is not None
    assert numpy.array_equal(named.facing[1], (cast.shadow & 1) == 1)
    assert numpy.array_equal(named.mapped[1], cast.facing[0])
    with pytest.raises(lightfit.InvalidArgumentError, match="facing_channel_format = \"x\""):
        lightfit.read_exr(cast.path, [low], facing_channel="x")


@pytest.mark.parametrize("border", ["lit", "dark", "auto"])
def test_every_border_is_that_of_the_program(
    fit_by_program: Any, cast: lightfit.ExrReadback, border: str
) -> None:
    lights = str(pathlib.Path(cast.path).with_suffix(".json"))
    want = fit_by_program(cast.path, "--lights", lights, "--border", border)
    options = {"border": border}
    result = lightfit.fit_exr(cast.path, lights, MAP, options=options, foretell_wrong=True)
    assert result.message == want
    assert {light.border for light in result.lights if light.ok} <= {"lit", "dark"}


@pytest.mark.parametrize("example", [YARD, ROOM])
def test_a_file_is_fitted_as_by_the_program(fit_by_program: Any, example: pathlib.Path) -> None:
    exr, lights = example / "0001.exr", example / "scene.json"
    want = fit_by_program(exr, "--lights", lights)
    result = lightfit.fit_exr(exr, lights, MAP, foretell_wrong=True)
    assert result.message == want


def test_a_light_without_a_channel_fails_alone(fit_by_program: Any, yard: Any) -> None:
    exr, lights = YARD / "0001.exr", YARD / "scene.json"
    want = fit_by_program(exr, "--lights", lights, "--light", "moon=sun:0,1,-1")
    moon = lightfit.Light.sun("moon", (0, 1, -1)).message
    result = lightfit.fit_exr(exr, [*yard.lights, moon], MAP, foretell_wrong=True)
    assert [light.ok for light in result.lights] == [True, True, True, False]
    assert result["moon"].status.code == "NOT_FOUND"
    assert '"shadow.moon"' in result["moon"].status.message
    assert result.message == want


def test_the_camera_may_be_given(fit_by_program: Any, yard: lightfit.ExrReadback) -> None:
    lights = YARD / "scene.json"
    want = fit_by_program(YARD / "0001.exr", "--lights", lights, "--camera", lights)
    import json

    scene = json.loads(lights.read_text())
    camera = lightfit.Camera.from_blender(
        scene["frames"][0]["camera_to_world"],
        scene["frames"][0]["projection"],
        width=180,
        height=180,
    )
    result = lightfit.fit_exr(
        YARD / "0001.exr", lights, MAP, camera=camera, foretell_wrong=True
    )
    assert result.message == want


def test_channels_may_be_named(yard: lightfit.ExrReadback) -> None:
    sun = light_pb2.Light(name="main", direction=yard.lights[0].direction)
    named = lightfit.read_exr(
        YARD / "0001.exr", [sun], depth_channel="Z", shadow_channels={"main": "shadow.sun"}
    )
    assert numpy.array_equal(named.shadow, yard.shadow & 1)
    assert numpy.array_equal(named.depth, yard.depth)


@pytest.mark.parametrize(
    "path, more, words",
    [
        ("absent.exr", {}, "absent.exr"),
        (YARD / "scene.json", {}, "scene.json"),
        (YARD / "0001.exr", {"depth_channel": "depth"}, '"depth"'),
        (YARD / "0001.exr", {"camera_convention": "maya"}, '"maya" is not known'),
        (YARD / "0001.exr", {"depth_kind": "z"}, "depth_kind = 'z'"),
    ],
)
def test_what_cannot_be_read_is_said_so(path: Any, more: Any, words: str) -> None:
    with pytest.raises(lightfit.LightfitError, match=words):
        lightfit.read_exr(path, YARD / "scene.json", **more)


def test_arrays_outlive_the_readback() -> None:
    depth = lightfit.read_exr(YARD / "0001.exr", YARD / "scene.json").depth
    copy = depth.copy()
    for _ in range(4):
        lightfit.read_exr(YARD / "0001.exr", YARD / "scene.json")
    assert numpy.array_equal(depth, copy)


def test_a_position_before_the_depth_is_no_depth(fit_by_program: Any) -> None:
    folder = YARD.parents[2] / "shared" / "cases" / "exr_position_part_before_depth"
    if not folder.exists():
        pytest.skip(f"no case at {folder}")
    exr, lights = folder / "frame.exr", folder / "lights.json"
    want = fit_by_program(exr, "--lights", lights)
    assert (want.readback.origin.depth_channel, want.readback.origin.depth_part) == ("Z", "depth")
    assert lightfit.fit_exr(exr, lights, MAP, foretell_wrong=True).message == want

    points = numpy.load(folder / "points.npz")
    for light in want.lights:
        rows = numpy.array(light.map_from_world.m).reshape(4, 4)
        here = numpy.c_[points[light.name], numpy.ones(len(points[light.name]))] @ rows.T
        u, v = here[:, 0] / here[:, 3], here[:, 1] / here[:, 3]
        assert (here[:, 3] > 0).all()
        covered = (u >= 0) & (v >= 0) & (u <= MAP[0]) & (v <= MAP[1])
        # The file's depth is in half precision, and the points are not.
        assert covered.mean() >= 0.99, light.name


def test_the_depth_of_a_wrong_view_is_refused(yard: lightfit.ExrReadback) -> None:
    assert yard.origin.depth_channel == "Z" and yard.origin.view == ""
    with pytest.raises(lightfit.LightfitError, match='no view "left"'):
        lightfit.read_exr(yard.path, list(yard.lights), view="left")
