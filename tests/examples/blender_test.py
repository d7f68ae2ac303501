"""examples/blender, in the real Blender and with the real server."""

from __future__ import annotations

import dataclasses
import json
import os
import pathlib
import shutil
import subprocess
from typing import Any, Dict, List

import numpy
import pytest
from google.protobuf import json_format

import lightfit
from conftest import EXAMPLES
from lightfit.v1 import result_pb2
from serving import Server, program

FIT_LIGHTS = EXAMPLES / "blender" / "fit_lights.py"
SCENE_SCRIPT = pathlib.Path(__file__).with_name("blender_scene.py")
EXIT_CODE = 3  # what --python-exit-code asks for

# Pixels whose shadow is that of lightfit's own rays. What is left are edges that pass within a
# hundredth of a pixel of a pixel's centre.
MIN_AGREEMENT = 0.999


@pytest.fixture(scope="module", autouse=True)
def needs_blender() -> None:
    if shutil.which("blender") is None:
        pytest.skip("blender is absent")


def blender(*words: Any) -> "subprocess.CompletedProcess[str]":
    return subprocess.run(
        ["blender", "-b", "--factory-startup", "--python-exit-code", str(EXIT_CODE)]
        + [str(word) for word in words],
        capture_output=True,
        text=True,
        timeout=250,
    )


def succeeded(done: "subprocess.CompletedProcess[str]") -> str:
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def error_of(*words: Any) -> str:
    """What a run of fit_lights.py that fails says last."""
    done = blender(*words)
    assert done.returncode == EXIT_CODE, done.stdout + done.stderr
    said = done.stdout + done.stderr
    assert "Traceback" not in said, said
    return said


@dataclasses.dataclass
class Fitted:
    """The demo scene, fitted once for all tests, and what came of it."""

    folder: pathlib.Path
    said: str
    message: result_pb2.FitResult  # OUT.json
    scene_file: Dict[str, Any]  # the kept 0001.json
    described: Dict[str, Any]  # the saved scene, opened again

    @property
    def camera(self) -> lightfit.Camera:
        frame = self.scene_file["frames"][0]
        return lightfit.Camera.from_blender(
            frame["camera_to_world"],
            frame["projection"],
            width=self.scene_file["width"],
            height=self.scene_file["height"],
        )

    @property
    def readback(self) -> lightfit.ExrReadback:
        return lightfit.read_exr(
            self.folder / "0001.exr", self.folder / "0001.json", camera=self.camera
        )


@pytest.fixture(scope="module")
def fitted(server: Server, tmp_path_factory: pytest.TempPathFactory) -> Fitted:
    folder = tmp_path_factory.mktemp("demo")
    said = succeeded(
        blender("-P", FIT_LIGHTS, "--", "--demo", "--server", server.address, "--map", "2048x1024",
                "--json", folder / "out.json", "--save", folder / "out.blend",
                "--keep-readback", folder)
    )
    succeeded(
        blender(folder / "out.blend", "-P", SCENE_SCRIPT, "--", folder / "scene.json",
                folder / "scene.obj")
    )
    return Fitted(
        folder,
        said,
        read_result(folder / "out.json"),
        json.loads((folder / "0001.json").read_text()),
        json.loads((folder / "scene.json").read_text()),
    )


def read_result(path: pathlib.Path) -> result_pb2.FitResult:
    return json_format.Parse(path.read_text(), result_pb2.FitResult())


def matrices(result: result_pb2.FitResult) -> List[List[float]]:
    return [
        list(matrix.m)
        for light in result.lights
        for matrix in (light.map_from_world, light.clip_from_world)
    ]


def test_it_fits_every_light_and_says_so(fitted: Fitted) -> None:
    assert [light.name for light in fitted.message.lights] == ["lamp", "spot", "sun"]
    for light in fitted.message.lights:
        assert light.status.code == 0 and light.energies.final > 0
        assert (light.map.width, light.map.height) == (2048, 1024)
        assert f"fit_lights: {light.name}: 2048x1024, energy" in fitted.said
    assert 'warning: light "spot": is a spot' in fitted.said
    assert (fitted.scene_file["width"], fitted.scene_file["height"]) == (320, 180)


def test_the_lights_carry_their_matrices_in_the_saved_scene(fitted: Fitted) -> None:
    for light in fitted.message.lights:
        properties = fitted.described["properties"][light.name]
        assert properties == {
            "lightfit_map_from_world": list(light.map_from_world.m),
            "lightfit_clip_from_world": list(light.clip_from_world.m),
            "lightfit_map_size": [2048, 1024],
            "lightfit_energy": light.energies.final,
        }


def test_the_kept_readback_gives_the_same_matrices_to_the_last_bit(fitted: Fitted) -> None:
    readback = fitted.readback
    here = lightfit.fit(
        readback.depth, readback.shadow, fitted.camera, readback.lights, (2048, 1024),
        facing=readback.facing,
    )
    assert {light.facing for light in fitted.message.lights} == {here.lights[0].message.facing}
    assert matrices(here.message) == matrices(fitted.message)
    again = fitted.folder / "again.json"
    kept = fitted.folder / "0001.json"
    subprocess.run(
        [program(), "fit", fitted.folder / "0001.exr", "--lights", kept, "--camera", kept,
         "--map", "2048x1024", "--border", "lit", "--json", again, "--quiet"],
        check=True,
    )
    assert matrices(read_result(again)) == matrices(fitted.message)


def test_the_camera_in_the_kept_header_is_the_scenes(fitted: Fitted) -> None:
    stored = lightfit.read_exr(fitted.folder / "0001.exr", fitted.folder / "0001.json")
    with_header = lightfit.fit(
        stored.depth, stored.shadow, stored.camera, stored.lights, (2048, 1024),
        facing=stored.facing,
    )
    for light, expected in zip(with_header.lights, fitted.message.lights):
        wanted = numpy.array(expected.map_from_world.m).reshape(4, 4)
        # The header has single precision.
        numpy.testing.assert_allclose(
            light.map_from_world, wanted, rtol=0, atol=1e-5 * numpy.abs(wanted).max()
        )


def test_depth_and_shadows_are_those_of_rays_through_the_same_meshes(fitted: Fitted) -> None:
    check_shadows(fitted, fitted.folder / "scene.obj", min_shadowed=0.02)


def check_shadows(fitted: Fitted, meshes: pathlib.Path, min_shadowed: float) -> None:
    """min_shadowed: share of the surface that each light leaves dark."""
    kept = fitted.folder / "0001.json"
    truth_exr = fitted.folder / "truth.exr"
    size = f"{fitted.scene_file['width']}x{fitted.scene_file['height']}"
    subprocess.run(
        [program(), "render", meshes, "--camera", kept, "--lights", kept, "--size", size, "-o",
         truth_exr, "--quiet"],
        check=True,
    )
    seen = fitted.readback
    truth = lightfit.read_exr(truth_exr, kept)
    surface = truth.depth < 1e9
    assert 0.5 < surface.mean() < 0.95
    assert ((seen.depth < 1e9) == surface).mean() >= MIN_AGREEMENT
    both = surface & (seen.depth < 1e9)
    assert numpy.quantile(numpy.abs(seen.depth - truth.depth)[both], 0.999) < 1e-4
    for bit, light in enumerate(seen.lights):
        blocked = (seen.shadow >> numpy.uint32(bit)) & 1
        expected = (truth.shadow >> numpy.uint32(bit)) & 1
        assert expected[both].mean() >= min_shadowed, light.name
        agreement = (blocked == expected)[both].mean()
        print(f"{light.name}: {100 * agreement:.3f} % of pixels agree")
        assert agreement >= MIN_AGREEMENT, light.name
        assert seen.facing is not None and truth.facing is not None
        faces, expected_faces = seen.facing[bit], truth.facing[bit]
        assert faces is not None and expected_faces is not None
        assert not (blocked & ~faces).any(), light.name
        agreement = (faces == expected_faces)[both].mean()
        print(f"{light.name}: {100 * agreement:.3f} % of pixels agree on what faces it")
        assert agreement >= MIN_AGREEMENT, light.name


def test_no_light_is_missed_among_many(
    fitted: Fitted, server: Server, tmp_path: pathlib.Path
) -> None:
    """As many as there are bits, weak and far ones and hidden in the viewport among them."""
    script = tmp_path / "add_lights.py"
    script.write_text(
        "import bpy, random\n"
        "random.seed(1)\n"
        "for number in range(29):\n"
        "    light = bpy.data.objects.new(f'more{number}', bpy.data.lights.new('more', 'POINT'))\n"
        "    bpy.context.scene.collection.objects.link(light)\n"
        "    light.location = [random.uniform(*r) for r in ((-5, 5), (-5, 5), (2, 60))]\n"
        "    light.data.energy = 10 ** random.uniform(-2, 4)\n"
        "    light.hide_viewport = number % 5 == 0\n"
    )
    succeeded(
        blender(fitted.folder / "out.blend", "-P", script, "-P", FIT_LIGHTS, "--", "--server",
                server.address, "--size", "160x90", "--keep-readback", tmp_path)
    )
    many = dataclasses.replace(
        fitted, folder=tmp_path, scene_file=json.loads((tmp_path / "0001.json").read_text())
    )
    assert len(many.readback.lights) == 32
    check_shadows(many, fitted.folder / "scene.obj", min_shadowed=0.0)


def test_soft_large_and_linked_lights_are_named(fitted: Fitted, server: Server, tmp_path) -> None:
    """The demo's sun has 5 degrees, its lamp a quarter metre at some metres from the boxes."""
    assert 'warning: light "sun": is a soft sun of 5 degrees' in fitted.said
    assert 'warning: light "lamp": has a radius of 0.25' in fitted.said
    script = tmp_path / "instance.py"
    script.write_text(
        "import bpy\n"
        "bpy.data.objects['sun'].data.angle = 0.0\n"
        "bpy.data.objects['lamp'].data.shadow_soft_size = 0.0\n"
        "rig = bpy.data.collections.new('rig')\n"
        "rig.objects.link(bpy.data.objects.new('inside', bpy.data.lights.new('inside', 'POINT')))\n"
        "empty = bpy.data.objects.new('empty', None)\n"
        "empty.instance_type, empty.instance_collection = 'COLLECTION', rig\n"
        "bpy.context.scene.collection.objects.link(empty)\n"
    )
    said = succeeded(
        blender(fitted.folder / "out.blend", "-P", script, "-P", FIT_LIGHTS, "--", "--server",
                server.address, "--size", "96x54", "--lights", "sun", "lamp")
    )
    assert 'warning: light "inside": is in the linked collection "rig"' in said
    assert 'light "sun"' not in said and 'light "lamp"' not in said


def test_outputs_are_looked_at_before_anything_is_rendered(tmp_path: pathlib.Path) -> None:
    """Without a server, which is asked after that."""
    (tmp_path / "file").write_text("")
    for flag, path, words in (
        ("--json", tmp_path / "none" / "out.json", "there is no folder"),
        ("--save", tmp_path, "is a folder"),
        ("--keep-readback", tmp_path / "file", "--keep-readback"),
    ):
        done = blender("-P", FIT_LIGHTS, "--", "--demo", "--server", "127.0.0.1:1", flag, path)
        assert done.returncode == EXIT_CODE
        assert words in done.stdout + done.stderr
        assert "Fra:" not in done.stdout  # Blender's word for a render


def test_an_open_scene_is_fitted_and_otherwise_left_as_it_is(
    fitted: Fitted, server: Server, tmp_path: pathlib.Path
) -> None:
    """Of another frame, for one light, in another clip space; once more for the same matrices."""
    for name in ("first", "second"):
        succeeded(
            blender(fitted.folder / "out.blend", "-P", FIT_LIGHTS, "--", "--server", server.address,
                    "--frame", "25", "--lights", "sun", "--clip", "direct3d", "--size", "160x90",
                    "--json", tmp_path / f"{name}.json", "--save", tmp_path / f"{name}.blend")
        )
    first, second = (read_result(tmp_path / f"{name}.json") for name in ("first", "second"))
    assert [light.name for light in first.lights] == ["sun"]
    assert matrices(first) == matrices(second)
    (sun,) = first.lights
    assert sun.clip.name == "direct3d"
    earlier = next(light for light in fitted.message.lights if light.name == "sun")
    assert list(sun.light.direction) != list(earlier.light.direction)  # it moves

    succeeded(
        blender(tmp_path / "first.blend", "-P", SCENE_SCRIPT, "--", tmp_path / "scene.json",
                tmp_path / "scene.obj")
    )
    described = json.loads((tmp_path / "scene.json").read_text())
    before, after = dict(fitted.described), dict(described)
    properties = after.pop("properties")
    kept_properties = before.pop("properties")
    assert after == before
    assert properties["lamp"] == kept_properties["lamp"]
    assert properties["sun"]["lightfit_clip_from_world"] == list(sun.clip_from_world.m)


def test_a_readback_leaves_no_trace_in_the_scene_also_when_it_fails() -> None:
    succeeded(blender("-P", SCENE_SCRIPT))


def test_a_light_without_shadows_fails_alone(
    server: Server, fitted: Fitted, tmp_path: pathlib.Path
) -> None:
    """The eye sees no shadow of a light that is in its place."""
    script = tmp_path / "move.py"
    script.write_text(
        "import bpy\n"
        "bpy.data.objects['spot'].location = bpy.context.scene.camera.location\n"
    )
    done = blender(fitted.folder / "out.blend", "-P", script, "-P", FIT_LIGHTS, "--", "--server",
                   server.address, "--size", "96x54", "--json", tmp_path / "out.json",
                   "--save", tmp_path / "out.blend")
    assert done.returncode == EXIT_CODE
    assert "fit_lights: spot: no matrix: " in done.stdout
    assert "no matrix for spot" in done.stdout + done.stderr
    codes = {light.name: light.status.code for light in read_result(tmp_path / "out.json").lights}
    assert codes["lamp"] == codes["sun"] == 0 and codes["spot"] != 0
    succeeded(
        blender(tmp_path / "out.blend", "-P", SCENE_SCRIPT, "--", tmp_path / "scene.json",
                tmp_path / "scene.obj")
    )
    properties = json.loads((tmp_path / "scene.json").read_text())["properties"]
    assert properties["spot"] == {}  # not those of the earlier fit
    assert len(properties["lamp"]) == 4


def test_errors_say_the_way_out(server: Server, fitted: Fitted, tmp_path: pathlib.Path) -> None:
    scene = fitted.folder / "out.blend"
    said = error_of(scene, "-P", FIT_LIGHTS, "--", "--server", "127.0.0.1:1")
    assert "--server 127.0.0.1:1" in said and "lightfit serve" in said
    said = error_of(scene, "-P", FIT_LIGHTS, "--", "--server", server.address, "--lights", "nope")
    assert "--lights nope" in said and "lamp, spot, sun" in said
    script = tmp_path / "no_camera.py"
    script.write_text("import bpy\nbpy.context.scene.camera = None\n")
    said = error_of(scene, "-P", script, "-P", FIT_LIGHTS, "--", "--server", server.address)
    assert "has no camera" in said and "Scene Properties" in said
    script.write_text("import bpy\nbpy.ops.wm.read_factory_settings(use_empty=True)\n")
    said = error_of("-P", script, "-P", FIT_LIGHTS, "--", "--server", server.address)
    assert "has no light that renders" in said


def test_it_says_how_to_find_the_package(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("PYTHONPATH")
    said = error_of("-P", FIT_LIGHTS, "--", "--demo")
    assert "PYTHONPATH" in said and "python3-grpcio" in said
