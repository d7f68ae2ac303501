"""Cameras, lights, conventions and options as messages; what is wrong with them, in words."""

import json
import pathlib
from typing import Any

import numpy
import pytest

import lightfit
from lightfit import Camera, Light
from lightfit.inputs import (
    camera_message,
    clip_message,
    light_messages,
    map_size_message,
    options_message,
)
from lightfit.v1 import camera_pb2, light_pb2, matrix_pb2, options_pb2

PROJECTION = numpy.array([[1.7, 0, 0, 0], [0, 1.7, 0, 0], [0, 0, -1.001, -0.2], [0, 0, -1, 0]])


def refused(match: str) -> Any:
    return pytest.raises(ValueError, match=match)


def test_matrices_are_row_major() -> None:
    world = numpy.eye(4)
    world[:3, 3] = (1, 2, 3)
    message = Camera.from_matrices(world, PROJECTION, clip="opengl").message
    assert list(message.camera_from_world.m)[3::4] == [1, 2, 3, 1]
    assert list(message.clip_from_camera.m) == PROJECTION.ravel().tolist()
    assert message.clip.depth_range == matrix_pb2.ClipConvention.DEPTH_RANGE_MINUS_ONE_TO_ONE
    assert message.depth_kind == camera_pb2.DEPTH_KIND_CAMERA_Z


def test_blender_gives_the_camera_in_the_world() -> None:
    message = Camera.from_blender(numpy.eye(4), PROJECTION, width=4, height=3).message
    assert message.WhichOneof("pose") == "world_from_camera"
    assert (message.width, message.height) == (4, 3)


@pytest.mark.parametrize(
    "matrix, words",
    [
        (numpy.eye(3), r"camera_from_world: has shape \(3, 3\), want \(4, 4\)"),
        (numpy.full((4, 4), numpy.nan), r"camera_from_world\[0, 0\] = nan, want 16 finite numbers"),
        ("view", "camera_from_world = 'view', want numbers"),
    ],
)
def test_matrices_that_are_none_are_refused(matrix: Any, words: str) -> None:
    with refused(words):
        Camera.from_matrices(matrix, PROJECTION, clip="opengl")


def test_words_that_are_not_known_are_refused_with_those_that_are() -> None:
    with refused("clip = 'metal', want one of vulkan, direct3d, opengl, reversed_z"):
        clip_message("metal")
    with refused("depth_kind = 'z', want one of camera-z, distance"):
        Camera.from_matrices(numpy.eye(4), PROJECTION, clip="opengl", depth_kind="z")


def test_the_camera_takes_the_size_of_the_depth() -> None:
    camera = Camera.from_matrices(numpy.eye(4), PROJECTION, clip="opengl")
    assert camera_message(camera, 7, 5).width == 7
    assert camera.message.width == 0
    sized = Camera.from_matrices(numpy.eye(4), PROJECTION, clip="opengl", width=5, height=7)
    with refused(r"camera: is 5 x 7 pixels and depth has shape \(5, 7\), want the same size"):
        camera_message(sized, 7, 5)
    with refused("camera: is a ndarray, want lightfit.Camera"):
        camera_message(numpy.eye(4), 7, 5)  # type: ignore[arg-type]


def test_lights_are_taken_in_every_form(tmp_path: pathlib.Path) -> None:
    path = tmp_path / "lights.json"
    path.write_text(json.dumps({"lights": [{"name": "sun", "direction": [0, 0, -1]}], "seed": 3}))
    want = light_pb2.Light(name="sun", direction=[0, 0, -1])
    for lights in (
        [Light.sun("sun", (0, 0, -1))],
        [{"name": "sun", "direction": [0, 0, -1]}],
        [want],
        path,
        str(path),
    ):
        assert light_messages(lights) == (want,)  # type: ignore[arg-type]
    assert Light.point("key", numpy.arange(3)).message.position == [0, 1, 2]


def test_lights_files_of_whole_scenes_are_understood(tmp_path: pathlib.Path) -> None:
    """As lightfit fit --lights does: a spot is a point, a dome fails alone; marks and UTF-16."""
    text = json.dumps({"lights": [
        {"name": "sun", "type": "PxrDistantLight", "position": [1, 2, 3], "direction": [0, 0, -1]},
        {"name": "spot", "position": [1, 2, 3], "direction": [0, 0, -1], "cone": 40},
        {"name": "env", "type": "DOME"},
        {"name": "panel", "kind": "area_light", "position": [1, 2, 3]},
    ]})
    want = (
        light_pb2.Light(name="sun", direction=[0, 0, -1]),
        light_pb2.Light(name="spot", position=[1, 2, 3]),
        light_pb2.Light(name="env"),
        light_pb2.Light(name="panel"),
    )
    path = tmp_path / "lights.json"
    for encoding in ("utf-8", "utf-8-sig", "utf-16"):
        path.write_bytes(text.encode(encoding))
        assert light_messages(path) == want


@pytest.mark.parametrize(
    "lights, words",
    [
        ([], "lights: 0 of them, want 1 to 32"),
        ([{"name": str(i)} for i in range(33)], "lights: 33 of them"),
        (Light.sun("sun", (0, 0, -1)), r"is one light, want a list of them: \[light\]"),
        ([3], r"lights\[0\]: is a int, want lightfit.Light or a dict"),
        ([{"name": "sun", "way": [1, 2, 3]}], r'lights\[0\]: .*"way"'),
        ("absent.json", "lights: absent.json: No such file"),
    ],
)
def test_lights_that_are_none_are_refused(lights: Any, words: str) -> None:
    with refused(words):
        light_messages(lights)


@pytest.mark.parametrize("text", ["", "[", "[]", '{"lights": 3}', '{"lights": [{"name": 3}]}'])
def test_lights_files_that_are_none_are_refused(tmp_path: pathlib.Path, text: str) -> None:
    path = tmp_path / "lights.json"
    path.write_text(text)
    with refused("lights.json: .*want"):
        light_messages(path)


def test_directions_are_three_numbers() -> None:
    with refused(r'light "sun": direction: has shape \(2,\), want 3 numbers'):
        Light.sun("sun", (0, 1))


@pytest.mark.parametrize("size", [(0, 4), (4,), 1024, (1.5, 2), ("a", "b"), (2**31, 1), None])
def test_map_sizes_that_are_none_are_refused(size: Any) -> None:
    with refused("map_size = .* want"):
        map_size_message(size)


def test_options_may_be_short_words() -> None:
    options = options_message(
        {"search": "focused", "metric": "METRIC_L2", "ray_space": "light-space",
         "margin_texels": 2, "samples": {"min_samples": 3}, "border": "auto"}
    )
    assert options == options_pb2.FitOptions(
        search=options_pb2.SEARCH_FOCUSED,  # type: ignore[arg-type]
        metric=options_pb2.METRIC_L2,  # type: ignore[arg-type]
        ray_space=options_pb2.RAY_SPACE_LIGHT_SPACE,  # type: ignore[arg-type]
        margin_texels=2,
        border=options_pb2.BORDER_CHOICE_AUTOMATIC,  # type: ignore[arg-type]
        samples=options_pb2.SampleOptions(min_samples=3),
    )
    assert options_message(None) is None


@pytest.mark.parametrize(
    "options, words",
    [
        ({"serch": "focused"}, 'options: .*"serch"'),
        ({"search": "nowhere"}, "options: .*nowhere"),
        ({"border": "red"}, "options: .*red"),
        ({"margin_texels": "two"}, "options: .*two"),
        ("focused", "options: is a str, want a dict"),
    ],
)
def test_options_that_are_none_are_refused(options: Any, words: str) -> None:
    with refused(words):
        options_message(options)


def test_tolerances_have_kinds() -> None:
    assert lightfit.Tolerance(1.5, 4).message.limit_px == 1.5
    with refused("tolerance: kind = 'mean', want rms, p99 or worst"):
        lightfit.Tolerance(1.5, kind="mean").message
