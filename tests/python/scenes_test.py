"""`lightfit render` on scene files: against an independent reader with brute force (gltf_reader.py),
and on files that other programs write."""

from __future__ import annotations

import json
import pathlib
from collections import Counter
from typing import Any, Callable, Dict, List, Tuple

import numpy
import pytest
from numpy.typing import NDArray

import lightfit
from lightfit.v1 import light_pb2
from gltf_reader import Array, Gltf, depth_image, pixel_rays
from gltf_samples import write_sample
from serving import REPOSITORY

SHARED = REPOSITORY.parent / "shared"
CASES = SHARED / "cases"

# Depths are floats, and vertices that the program keeps as floats.
DEPTH_TOLERANCE = 2e-6

# Of a triangle's size: a ray that passes an edge so closely may hit either side.
EDGE_MARGIN = 2e-6

BACKGROUND = 1e9

Render = Callable[..., lightfit.ExrReadback]


@pytest.fixture
def render(tmp_path: pathlib.Path, run_lightfit: Any) -> Render:
    """What `lightfit render` makes of a scene, with its lights or one straight down."""
    pytest.importorskip("lightfit._native")

    def run(scene: pathlib.Path, *arguments: Any) -> lightfit.ExrReadback:
        exr, lights = tmp_path / "out.exr", tmp_path / "out.json"
        if not any(str(argument).startswith("--light") for argument in arguments):
            arguments += ("--light", "down=sun:0.1,0.2,-1")
        done = run_lightfit("render", scene, "-o", exr, "--lights-out", lights, *arguments)
        assert done.returncode == 0, done.stderr
        return lightfit.read_exr(exr, lights)

    return run


def text(vector: Any) -> str:
    return ",".join(repr(float(value)) for value in vector)


def expect_depth(
    render: Render,
    path: pathlib.Path,
    view: Tuple[Array, Array, Array],
    size: Tuple[int, int],
    triangles: Array,
) -> int:
    """Compares every pixel's depth with brute force; the number of surfaces."""
    eye, target, up = view
    fov_deg, (width, height) = 50.0, size
    shown = render(
        path, f"--camera={text(eye)}:{text(target)}:{fov_deg}", f"--up={text(up)}",
        "--size", f"{width}x{height}",
    )
    rays = pixel_rays(eye, target, up, fov_deg, width, height)
    depth, unsure = depth_image(triangles, eye, rays, EDGE_MARGIN)
    found = numpy.where(shown.depth > BACKGROUND, numpy.inf, shown.depth.astype(float))
    close = numpy.isclose(found, depth, rtol=DEPTH_TOLERANCE)
    assert (close | unsure).all(), f"{path}: {(~(close | unsure)).sum()} of {close.size} pixels"
    assert unsure.mean() < 0.02
    return int(numpy.isfinite(depth).sum())


def test_random_gltf_files_have_the_depth_of_an_independent_reader(
    render: Render, tmp_path: pathlib.Path
) -> None:
    features: Counter[str] = Counter()
    surfaces, first, count = 0, 1400, 24
    print(f"seeds {first} to {first + count - 1}")
    for seed in range(first, first + count):
        folder = tmp_path / f"seed {seed}"
        folder.mkdir()
        path, has = write_sample(seed, folder)
        features.update(has)
        view = (numpy.array([1.0, -9.0, 6.0]), numpy.array([0.0, 0.5, 0.0]), numpy.eye(3)[2])
        surfaces += expect_depth(render, path, view, (32, 24), Gltf(path).triangles())
    assert surfaces > 0.5 * count * 32 * 24
    for feature in ("plain matrix nested instances skin morph quantized sparse sparse_from_zeros "
                    "strip no_indices interleaved node_weights two_sets_of_joints packed_weights "
                    "packed_rotations percent_uri data_uri byte_order_mark").split():
        assert features[feature] > 1, f"{feature} in {features[feature]} of {count} files"


@pytest.mark.parametrize(
    "name, eye, target",
    [
        ("sponza_atrium", (8.0, 2.0, 0.3), (-3.0, 3.0, 0.0)),
        ("denhaag_city", (-300.0, 120.0, -250.0), (0.0, 0.0, 0.0)),
        ("objects_floor", (3.0, 1.6, 3.5), (0.0, 0.4, 0.0)),
        ("shadow_columns", (30.0, 6.0, 20.0), (0.0, 0.0, 0.0)),
    ],
)
def test_real_files_have_the_depth_of_an_independent_reader(
    render: Render, name: str, eye: Any, target: Any
) -> None:
    path = SHARED / "scenes" / f"{name}.glb"
    if not path.exists():
        pytest.skip("no ../shared/scenes: the development scenes are not part of the repository")
    view = (numpy.array(eye), numpy.array(target), numpy.array([0.0, 1.0, 0.0]))
    assert expect_depth(render, path, view, (20, 14), Gltf(path).triangles()) > 150


# --- Files that stand in ../shared/cases ----------------------------------------------------------


def case(name: str) -> pathlib.Path:
    folder = CASES / name
    if not folder.exists():
        pytest.skip("no ../shared/cases: they are not part of the repository")
    return folder


@pytest.mark.parametrize(
    "folder, scene",
    [
        ("glb_gpu_instancing", "boxes.glb"),
        ("glb_skin_and_morph", "skinned.glb"),
        ("glb_skin_and_morph", "morphed.glb"),
        ("gltf_percent_uri", "boxes.gltf"),
        ("obj_leading_dot", "boxes.obj"),
        ("ply_tristrips", "boxes.ply"),
    ],
)
def test_a_case_has_the_depth_and_shadows_that_it_says(
    render: Render, folder: str, scene: str
) -> None:
    where = case(folder)
    shown = render(
        where / scene, "--camera", where / "camera.json", "--lights", where / "lights.json",
        "--size", "120x90",
    )
    expected = numpy.load(where / "expected.npz")
    assert (numpy.isclose(shown.depth, expected["Z"], rtol=1e-5)).all()
    for bit, light in enumerate(("sun", "lamp")):
        shadow = (shown.shadow >> numpy.uint32(bit)) & 1
        # Floats at the very edge of a shadow.
        assert (shadow != expected[f"shadow.{light}"]).mean() < 5e-4


@pytest.mark.parametrize("scene", ["boxes.obj", "boxes.gltf"])
def test_a_byte_order_mark_is_skipped(render: Render, scene: str) -> None:
    view = ("--camera=-1,-6.5,2.6:0.3,0.6,0.3:50", "--up", "0,0,1", "--size", "120x90")
    light = ("--light", "s=sun:-0.6,0.35,-0.72")
    shown = render(case("json_byte_order_mark") / scene, *view, *light)
    without = render(case("ply_tristrips") / "boxes.ply", *view, *light)
    assert numpy.isclose(shown.depth, without.depth, rtol=1e-5).all()
    assert (shown.shadow == without.shadow).all()


def test_the_gap_of_a_concave_polygon_is_open(render: Render) -> None:
    where = case("ply_concave_polygon")
    shown = render(
        where / "wall.ply", "--camera", where / "camera.json", "--lights", where / "lights.json",
        "--size", "160x120",
    )
    camera = json.loads((where / "camera.json").read_text())
    pose = numpy.array(camera["cameraFromWorld"]["m"]).reshape(4, 4)
    lens = camera["intrinsics"]
    x = (numpy.arange(160) + 0.5 - lens["cx"]) / lens["fx"]
    y = (numpy.arange(120) + 0.5 - lens["cy"]) / lens["fy"]
    rays = numpy.stack(numpy.broadcast_arrays(x[None, :], y[:, None], 1.0), -1) @ pose[:3, :3]
    eye = -pose[:3, :3].T @ pose[:3, 3]
    # Where the ray of each pixel meets the wall's plane, and whether that is within the outline.
    wall = json.loads((where / "wall.json").read_text())
    depth = (wall["plane_y"] - eye[1]) / rays[..., 1]
    at = eye + depth[..., None] * rays
    inside = is_inside(wall["outline_x_z"], at[..., 0], at[..., 2]) & (depth > 0)
    is_wall = numpy.isclose(shown.depth, depth, rtol=1e-5)
    assert inside.sum() > 1500 and (is_wall == inside).all()


def is_inside(outline: List[List[float]], x: Array, y: Array) -> "NDArray[numpy.bool_]":
    inside = numpy.zeros(x.shape, bool)
    for (ax, ay), (bx, by) in zip(outline, outline[1:] + outline[:1]):
        if ay != by:
            inside ^= ((ay > y) != (by > y)) & (x < ax + (y - ay) / (by - ay) * (bx - ax))
    return inside


# --- Far from the origin --------------------------------------------------------------------------

# A scene of some metres with details of centimetres. Its coordinates are multiples of 2^-9, which
# doubles hold exactly 1e7 away and decimals write exactly.
CORNERS = numpy.round(
    numpy.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], float) * 512
) / 512
QUADS = [(0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4), (1, 3, 7, 5)]


def boxes_at(origin: Array) -> Tuple[Array, List[Tuple[int, ...]]]:
    points = [numpy.array([[-6, -6, 0], [6, -6, 0], [6, 6, 0], [-6, 6, 0]], float)]
    faces: List[Tuple[int, ...]] = [(0, 1, 2, 3)]
    random = numpy.random.default_rng(14)
    for _ in range(12):
        size = numpy.round(random.uniform(0.05, 1.5, 3) * 512) / 512
        low = numpy.round(numpy.append(random.uniform(-3, 3, 2), 0) * 512) / 512
        first = sum(len(part) for part in points)
        points.append(low + CORNERS * size)
        faces += [tuple(first + corner for corner in quad) for quad in QUADS]
    return numpy.concatenate(points) + origin, faces


def write_obj(path: pathlib.Path, origin: Array) -> None:
    points, faces = boxes_at(origin)
    lines = ["v " + " ".join(repr(float(value)) for value in point) for point in points]
    lines += ["f " + " ".join(str(corner + 1) for corner in face) for face in faces]
    path.write_text("\n".join(lines))


def write_ply(path: pathlib.Path, origin: Array) -> None:
    points, faces = boxes_at(origin)
    header = (
        f"ply\nformat ascii 1.0\nelement vertex {len(points)}\nproperty double x\n"
        f"property double y\nproperty double z\nelement face {len(faces)}\n"
        "property list uchar int vertex_indices\nend_header\n"
    )
    # What stands behind the coordinates is not in the header.
    lines = [" ".join(repr(float(value)) for value in point) + " 255 0 0" for point in points]
    lines += [" ".join(map(str, (len(face), *face))) for face in faces]
    path.write_text(header + "\n".join(lines) + "\n")


def write_gltf(path: pathlib.Path, origin: Array) -> None:
    """The node is far out, its mesh near zero."""
    points, faces = boxes_at(numpy.zeros(3))
    corners = [t for a, b, c, d in faces for t in (a, b, c, a, c, d)]
    data = points.astype("<f4").tobytes() + numpy.array(corners, "<u2").tobytes()
    path.with_suffix(".bin").write_bytes(data)
    views = [
        {"buffer": 0, "byteLength": 12 * len(points)},
        {"buffer": 0, "byteOffset": 12 * len(points), "byteLength": 2 * len(corners)},
    ]
    document: Dict[str, Any] = {
        "asset": {"version": "2.0"},
        "nodes": [{"mesh": 0, "translation": list(map(float, origin))}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": len(points), "type": "VEC3"},
            {"bufferView": 1, "componentType": 5123, "count": len(corners), "type": "SCALAR"},
        ],
        "bufferViews": views,
        "buffers": [{"byteLength": len(data), "uri": path.with_suffix(".bin").name}],
    }
    path.write_text(json.dumps(document))


@pytest.mark.parametrize("write, name", [
    (write_obj, "a.obj"), (write_ply, "a.ply"), (write_gltf, "a.gltf"),
])
def test_a_scene_far_from_the_origin_has_the_pixels_of_the_same_at_it(
    render: Render, tmp_path: pathlib.Path, write: Callable[..., None], name: str
) -> None:
    def shown(origin: Array) -> lightfit.ExrReadback:
        write(tmp_path / name, origin)
        eye, target = numpy.array([1.0, -7.0, 4.0]), numpy.array([0.0, 0.5, 0.25])
        lamp = numpy.array([-2.5, 1.0, 5.0])
        return render(
            tmp_path / name, f"--camera={text(origin + eye)}:{text(origin + target)}:50",
            "--up", "0,0,1", "--size", "96x72", f"--light=lamp=point:{text(origin + lamp)}",
            "--light", "sun=sun:0.5,0.3,-1",
        )

    near = shown(numpy.zeros(3))
    assert 0.02 < (near.shadow & 1).mean() < 0.9
    for origin in ([5e5, 4.5e6, 0.0], [1e6, -1e6, 30.0], [1e7, 1e7, -1e7]):
        far = shown(numpy.array(origin))
        # A ray that passes an edge within a double's rounding out there, 2e-9, may miss it.
        assert (numpy.isclose(far.depth, near.depth, rtol=1e-6)).mean() > 0.9995
        assert (far.shadow == near.shadow).mean() > 0.9995


# --- Lights and cameras of a glTF file ------------------------------------------------------------


def add_view(path: pathlib.Path) -> None:
    """A camera, 3 by 2, and two lights beside what the file holds, under turned nodes."""
    document = json.loads(path.read_text())
    nodes = document["nodes"]
    # Half a turn about the diagonal between two axes exchanges them: y becomes up.
    half = 2 ** -0.5
    nodes += [
        {"name": "eye", "camera": 0, "translation": [1, -7, 0.5], "rotation": [half, 0, 0, half]},
        {"name": "lamp", "translation": [-2.5, 1, 5],
         "extensions": {"KHR_lights_punctual": {"light": 0}}},
        {"name": "tilted", "rotation": [0.0, numpy.sin(0.3), 0.0, numpy.cos(0.3)],
         "children": [len(nodes) + 3]},
        {"name": "sun", "extensions": {"KHR_lights_punctual": {"light": 1}}},
    ]
    document["cameras"] = [
        {"type": "perspective", "perspective": {"yfov": 0.9, "aspectRatio": 1.5, "znear": 0.1}}
    ]
    document["extensions"] = {
        "KHR_lights_punctual": {"lights": [{"type": "spot"}, {"type": "directional"}]}
    }
    path.write_text(json.dumps(document))


def test_a_gltf_file_brings_its_own_camera_and_lights(
    tmp_path: pathlib.Path, run_lightfit: Any
) -> None:
    pytest.importorskip("lightfit._native")
    scene = tmp_path / "a.gltf"
    write_gltf(scene, numpy.zeros(3))
    add_view(scene)
    own, given = tmp_path / "own.exr", tmp_path / "given.exr"
    done = run_lightfit("render", scene, "-o", own)
    assert done.returncode == 0, done.stderr
    assert f"camera and lights of {scene}" in done.stdout and "270x180" in done.stdout
    sun = f"{-numpy.sin(0.6)!r},0,{-numpy.cos(0.6)!r}"
    done = run_lightfit(
        "render", scene, "--camera", f"1,-7,0.5:1,0,0.5:{numpy.degrees(0.9)!r}", "--up", "0,0,1",
        "--size", "270x180", "--light", "lamp=point:-2.5,1,5", "--light", f"sun=sun:{sun}",
        "-o", given,
    )
    assert done.returncode == 0 and "camera and lights of" not in done.stdout
    first, second = lightfit.read_exr(own, scene_lights(sun)), lightfit.read_exr(given, scene_lights(sun))
    assert numpy.isclose(first.depth, second.depth, rtol=1e-6).mean() > 0.9995
    assert (first.shadow == second.shadow).mean() > 0.9995 and (first.shadow > 0).any()
    # And `fit` takes both from the file, instead of those that it is told.
    results = []
    for more in (["--lights", scene], ["--lights", scene, "--camera", f"{scene}:eye"]):
        out = tmp_path / "fit.json"
        done = run_lightfit("fit", own, *more, "--json", out, "--quiet")
        assert done.returncode == 0, done.stderr
        results.append([
            light["energies"]["final"] for light in json.loads(out.read_text())["lights"]
        ])
    assert len(results[0]) == 2 and numpy.allclose(results[0], results[1], rtol=1e-5)


def scene_lights(sun: str) -> List[light_pb2.Light]:
    direction = [float(number) for number in sun.split(",")]
    return [
        light_pb2.Light(name="lamp", position=[-2.5, 1, 5]),
        light_pb2.Light(name="sun", direction=direction),
    ]


def test_a_gltf_file_of_several_cameras_lists_them(
    tmp_path: pathlib.Path, run_lightfit: Any
) -> None:
    scene = tmp_path / "a.gltf"
    write_gltf(scene, numpy.zeros(3))
    add_view(scene)
    document = json.loads(scene.read_text())
    document["nodes"].append({"name": "other", "camera": 0})
    scene.write_text(json.dumps(document))
    done = run_lightfit("render", scene, "-o", tmp_path / "a.exr")
    assert done.returncode == 2 and "a.gltf:eye, a.gltf:other" in done.stderr
    done = run_lightfit("render", scene, "--camera", f"{scene}:eye", "-o", tmp_path / "a.exr")
    assert done.returncode == 0, done.stderr
    assert f"lights of {scene}" in done.stdout and "camera and" not in done.stdout
