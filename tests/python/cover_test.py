"""Covers finer than the read-back: here, by the program, and by a server."""

import pathlib
import re
import subprocess
from typing import Any, Tuple

import numpy
import pytest
from google.protobuf import json_format

import lightfit
from conftest import without_yardsticks
from lightfit.v1 import result_pb2
from readbacks import large_readback
from serving import program

MAP = (512, 512)
LIGHTS = ("--light", "low=sun:1,-0.6,0.3", "--light", "lamp=point:-4,6,5")


@pytest.fixture(scope="module")
def files(tmp_path_factory: Any) -> Tuple[pathlib.Path, pathlib.Path, pathlib.Path]:
    """A read-back with thin things, the same frame with more pixels, and the lights."""
    pytest.importorskip("lightfit._native")
    folder = tmp_path_factory.mktemp("cover")
    for name, size in (("small", "60x40"), ("large", "480x320")):
        done = subprocess.run(
            [program(), "render", "generate:objects=40,triangles=6000", "--camera",
             "0,1.7,18:0,0.5,0", *LIGHTS, "--size", size, "-o", str(folder / f"{name}.exr"),
             "--lights-out", str(folder / "lights.json"), "--quiet"],
            capture_output=True, text=True,
        )
        assert done.returncode == 0, done.stderr
    return folder / "small.exr", folder / "large.exr", folder / "lights.json"


def matrices(result: lightfit.FitResult) -> Any:
    return [light.map_from_world for light in result.lights]


@pytest.mark.parametrize("border", ["lit", "auto"])
def test_a_cover_is_that_of_the_program(
    files: Any, tmp_path: pathlib.Path, run_lightfit: Any, border: str
) -> None:
    small, large, lights = files
    json = tmp_path / "fit.json"
    run_lightfit("fit", small, "--lights", lights, "--map", "512x512", "--border", border,
                 "--cover-readback", large, "--json", json, "--quiet")
    want = json_format.Parse(json.read_text(), result_pb2.FitResult())
    for light in want.lights:
        without_yardsticks(light)
    options = {"border": border}
    result = lightfit.fit_exr(
        small, lights, MAP, options=options, foretell_wrong=True, cover=large
    )
    assert result.ok and result.message == want
    without = lightfit.fit_exr(small, lights, MAP, options=options)
    assert any(
        not numpy.array_equal(one, other)
        for one, other in zip(matrices(result), matrices(without))
    )


def test_a_cover_may_be_given_in_many_forms(files: Any, client: Any) -> None:
    small, large, lights = files
    coarse, fine = lightfit.read_exr(small, lights), lightfit.read_exr(large, lights)
    first = (coarse.depth, coarse.shadow, coarse.camera, coarse.lights, MAP)
    options = {"border": "auto"}
    want = lightfit.fit_exr(small, lights, MAP, options=options, cover=large)
    assert coarse.facing is not None and fine.facing is not None
    low, lamp = (numpy.asarray(plane) for plane in fine.facing)
    planes = numpy.stack([(fine.shadow >> light) & 1 for light in range(2)]).astype(bool)
    lit = [plane & ~blocked for plane, blocked in zip((low, lamp), planes)]
    served = numpy.stack([plane & blocked for plane, blocked in zip((low, lamp), planes)])
    for cover in (
        lightfit.FineCover(fine.depth, fine.shadow, fine.facing),
        lightfit.FineCover(fine.depth, planes, [low, lamp]),
        lightfit.FineCover(fine.depth, served, lit=lit),
    ):
        for calls in (lightfit, client):
            result = calls.fit(*first, options=options, facing=coarse.facing, cover=cover)
            assert [list(light.message.map_from_world.m) for light in result.lights] == [
                list(light.message.map_from_world.m) for light in want.lights
            ]


# Two by two pixels to a cell: their nearest and furthest surfaces, any of their bits.
def test_cells_hold_what_their_pixels_do(files: Any) -> None:
    small, large, lights = files
    coarse, fine = lightfit.read_exr(small, lights), lightfit.read_exr(large, lights)
    cells = fine.depth.reshape(160, 2, 240, 2)
    furthest = numpy.where(cells < 1e9, cells, 0).max(axis=(1, 3))
    planes = numpy.stack([(fine.shadow >> light) & 1 for light in range(2)]).astype(bool)
    facing = numpy.stack([numpy.asarray(plane) for plane in fine.facing or ()])
    blocked = (planes & facing).reshape(2, 160, 2, 240, 2).any(axis=(2, 4))
    cover = lightfit.FineCover(
        cells.min(axis=(1, 3)), blocked,
        furthest=numpy.where(furthest > 0, furthest, numpy.float32(1e10)),
    )
    result = lightfit.fit(
        coarse.depth, coarse.shadow, coarse.camera, coarse.lights, MAP,
        facing=coarse.facing, cover=cover,
    )
    assert result.ok
    camera = fine.camera.message
    world_from_camera = numpy.linalg.inv(
        numpy.array(camera.camera_from_world.m).reshape(4, 4)
    )
    x = (numpy.arange(480) + 0.5 - camera.intrinsics.cx) / camera.intrinsics.fx
    y = (numpy.arange(320) + 0.5 - camera.intrinsics.cy) / camera.intrinsics.fy
    rays = numpy.stack(numpy.broadcast_arrays(x[None], y[:, None], 1.0), axis=-1)
    points = rays * fine.depth[..., None].astype(float)
    world = points @ world_from_camera[:3, :3].T + world_from_camera[:3, 3]
    for light, is_blocked in zip(result.lights, planes & facing):
        matrix = light.map_from_world
        assert matrix is not None and is_blocked.sum() > 100
        at = world[is_blocked] @ matrix[[0, 1, 3], :3].T + matrix[[0, 1, 3], 3]
        u, v = at[:, 0] / at[:, 2], at[:, 1] / at[:, 2]
        inside = (at[:, 2] > 0) & (u >= 0) & (v >= 0) & (u < 512) & (v < 512)
        assert inside.all()


def test_a_server_takes_covers_in_chunks_and_in_tracks(client: Any) -> None:
    small, large = large_readback(150, 100), large_readback(1500, 1000)  # 12 MB: is streamed
    cover = lightfit.FineCover(large[0], large[1], furthest=large[0] + numpy.float32(0.01))
    want = lightfit.fit(*small, MAP, cover=cover)
    assert want.ok and client.fit(*small, MAP, cover=cover).message == want.message
    assert want.message != lightfit.fit(*small, MAP).message
    with lightfit.track(MAP) as here, client.track(MAP) as there:
        for number in range(2):
            result = here.update(number, *small, cover=cover)
            assert there.update(number, *small, cover=cover).message == result.message
    candidates = [
        lightfit.Candidate.map(light.name, light.map_from_world, MAP)
        for light in want.lights
        if light.map_from_world is not None
    ]
    few = large_readback(300, 200)
    cover = lightfit.FineCover(few[0], few[1])
    judged = lightfit.evaluate(*small, candidates, cover=cover)
    assert client.evaluate(*small, candidates, cover=cover).message == judged.message
    sizes = lightfit.allocate(*small, budget_texels=1 << 18, cover=cover)
    assert client.allocate(*small, budget_texels=1 << 18, cover=cover).message == sizes.message


def test_what_is_wrong_with_a_cover_is_said() -> None:
    depth, shadow, camera, lights = large_readback(60, 40)
    fine = large_readback(120, 80)

    def refused(cover: Any, words: str) -> None:
        with pytest.raises(lightfit.InvalidArgumentError, match=re.escape(words)):
            lightfit.fit(depth, shadow, camera, lights, MAP, cover=cover)

    refused(lightfit.FineCover(depth, shadow), "60 x 40 cells, want more than")
    refused(fine[0], "cover: is a ndarray, want lightfit.FineCover")
    refused(lightfit.FineCover(fine[0], shadow), "cover: shadow: has shape")
    refused(lightfit.FineCover(fine[0], fine[1], furthest=depth), "cover: furthest: has shape")
    doubles = fine[0].astype(numpy.float64)
    refused(
        lightfit.FineCover(fine[0], fine[1], furthest=doubles),
        "cover: furthest: has dtype float64, want float32 or float16: furthest.astype(",
    )
    refused(lightfit.FineCover(doubles, fine[1]), "cover: depth: has dtype float64")
    refused(lightfit.FineCover(fine[0], fine[1], fine[1], lit=fine[1]), "not both")


@pytest.mark.parametrize("border", ["lit", "auto"])
def test_plans_look_at_it_as_those_of_the_program_do(
    files: Any, tmp_path: pathlib.Path, run_lightfit: Any, client: Any, border: str
) -> None:
    small, large, lights = files
    json = tmp_path / "plan.json"
    run_lightfit("fit", small, "--lights", lights, "--maps", 2, "--texels", 90000, "--border", border,
                 "--cover-readback", large, "--json", json, "--quiet")
    want = json_format.Parse(json.read_text(), result_pb2.FitResult())
    plan = {"max_maps": 2, "texels": 90000}
    options = {"border": border}
    result = lightfit.fit_plan_exr(small, lights, plan, options=options, cover=large)
    assert result.ok
    assert [light.plan for light in result.message.lights] == [light.plan for light in want.lights]
    served = client.fit_plan_exr(small, lights, plan, options=options, cover=large)
    assert served.message == result.message
    without = lightfit.fit_plan_exr(small, lights, plan, options=options)
    assert any(
        one.plan != other.plan
        for one, other in zip(result.message.lights, without.message.lights)
    )


def test_plans_that_are_tracked_do_without() -> None:
    small, large = large_readback(60, 40), large_readback(240, 160)
    with lightfit.track_plan({"max_maps": 2, "texels": 9000}) as track:
        with pytest.raises(lightfit.InvalidArgumentError, match="tracked do not look at it"):
            track.update(0, *small, cover=lightfit.FineCover(large[0], large[1]))
