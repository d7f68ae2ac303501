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
    depth_kind_number,
    light_messages,
    map_size_message,
    options_message,
    plan_message,
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
    with refused(
        "clip = 'reversed_y', want one of vulkan, direct3d, opengl, reversed-z, direct3d-reversed; "
        'did you mean "reversed-z"'
    ):
        clip_message("reversed_y")
    with refused("clip = 3, want one of vulkan"):
        clip_message(3)  # type: ignore[arg-type]
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
    "spelled, name",
    [
        ("reversed-z", "reversed_z"),
        ("Reversed_Z", "reversed_z"),
        ("direct3d-reversed", "direct3d_reversed"),
        ("METAL", "direct3d"),
        ("WebGPU-reversed", "direct3d_reversed"),
        ("D3D12", "direct3d"),
        ("OpenGL", "opengl"),
        ("Vulkan", "vulkan"),
    ],
)
def test_clip_spaces_are_read_as_people_write_them(spelled: str, name: str) -> None:
    assert clip_message(spelled).name == name


def test_depth_kinds_are_read_in_any_case() -> None:
    for kind in ("camera-z", "Camera_Z"):
        assert depth_kind_number(kind) == camera_pb2.DEPTH_KIND_CAMERA_Z
    assert depth_kind_number("NDC-reversed") == camera_pb2.DEPTH_KIND_NDC_REVERSED_ZERO_TO_ONE


# Every word of the command line: --metric, --search, --affine, --cover, --border.
@pytest.mark.parametrize(
    "field, word, number",
    [
        ("metric", "l2", options_pb2.METRIC_L2),
        ("metric", "l2-edge", options_pb2.METRIC_L2_ACROSS_EDGE),
        ("metric", "L1", options_pb2.METRIC_L1),
        ("metric", "L1-Edge", options_pb2.METRIC_L1_ACROSS_EDGE),
        ("metric", "l1_across_edge", options_pb2.METRIC_L1_ACROSS_EDGE),
        ("metric", "METRIC_L1_ACROSS_EDGE", options_pb2.METRIC_L1_ACROSS_EDGE),
        ("metric", options_pb2.METRIC_L1_ACROSS_EDGE, options_pb2.METRIC_L1_ACROSS_EDGE),
        ("search", "focused", options_pb2.SEARCH_FOCUSED),
        ("search", "line", options_pb2.SEARCH_ROTATION_LINE_SEARCH),
        ("search", "refine", options_pb2.SEARCH_ROTATION_LINE_SEARCH_REFINED),
        ("search", "Global", options_pb2.SEARCH_GLOBAL),
        ("affine", "rectangle", options_pb2.AFFINE_MIN_AREA_RECTANGLE),
        ("affine", "cgal-rectangle", options_pb2.AFFINE_MIN_AREA_RECTANGLE_CGAL),
        ("affine", "skewed", options_pb2.AFFINE_SKEWED_RECTANGLE),
        ("affine", "parallelogram", options_pb2.AFFINE_MIN_ENERGY_PARALLELOGRAM),
        ("cover", "shadowed", options_pb2.COVER_SHADOWED),
        ("cover", "receivers", options_pb2.COVER_RECEIVERS),
        ("border", "lit", options_pb2.BORDER_CHOICE_LIT),
        ("border", "dark", options_pb2.BORDER_CHOICE_DARK),
        ("border", "AUTO", options_pb2.BORDER_CHOICE_AUTOMATIC),
    ],
)
def test_options_take_the_words_of_the_command_line(field: str, word: Any, number: int) -> None:
    message = options_message({field: word})
    assert message is not None and getattr(message, field) == number


def test_sizes_may_be_words() -> None:
    assert map_size_message("1024X512") == map_size_message((1024, 512))
    plan = plan_message({"max_maps": 2, "texels": "1024x1024"})
    assert plan.texels == 1 << 20
    assert plan_message({"each": "512x256"}).each == map_size_message((512, 256))
    for wrong in ("1024", "1024x", "x", "1024 by 1024", "-1x3", "1.5x2"):
        with refused(f"map_size = '{wrong}', want"):
            map_size_message(wrong)


@pytest.mark.parametrize(
    "options, words",
    [
        ({"serch": "focused"}, 'there is no "serch", want some of .*; did you mean "search"'),
        ({"search": "nowhere"}, "search = 'nowhere', want one of focused, line, refine, global"),
        ({"metric": "l1-edges"}, 'l1, l1-edge; did you mean "l1-edge"'),
        ({"metric": "unspecified"}, "metric = 'unspecified', want one of l2, l2-edge"),
        ({"border": "red"}, "border = 'red', want one of lit, dark, auto"),
        ({"margin_texels": "two"}, "options: .*two"),
        ("focused", "options: is a str, want a dict"),
    ],
)
def test_options_that_are_none_are_refused(options: Any, words: str) -> None:
    with refused(words):
        options_message(options)


def test_tolerances_have_kinds() -> None:
    assert lightfit.Tolerance(1.5, 4).message.limit_px == 1.5
    assert lightfit.Tolerance.parse("P99:1.5", 4).message == lightfit.Tolerance(1.5, 4).message
    for words in ("p99", "p99:", "1.5", "p99:much"):
        with refused(f"tolerance = '{words}', want rms:PIXELS"):
            lightfit.Tolerance.parse(words)
    with refused("tolerance: kind = 'mean', want one of rms, p99, worst"):
        lightfit.Tolerance(1.5, kind="mean").message
