"""Fits the light matrices of the open scene: renders a read-back, asks a lightfit server, and
writes the matrices onto the lights.

    lightfit serve &
    blender -b SCENE.blend --python-exit-code 3 -P fit_lights.py -- --json matrices.json

`-- --help` lists the options; README.md says what becomes of the lights.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
from typing import Any, List, Tuple

import bpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import demo_scene
from readback import Readback, SceneError, render_readback

DEFAULT_WIDTH = 320  # pixels of the read-back

# What the lights carry afterwards.
PROPERTIES = (
    "lightfit_map_from_world",
    "lightfit_clip_from_world",
    "lightfit_map_size",
    "lightfit_energy",
)


class FitLightsError(Exception):
    """One line that says what is wrong and the way out."""


def main() -> None:
    flags = parse_flags()
    lightfit = import_lightfit()
    if flags.demo:
        demo_scene.make_demo_scene()
    scene, view_layer = bpy.context.scene, bpy.context.view_layer
    lights = chosen_lights(scene, view_layer, flags.lights)
    with lightfit.Client(flags.server) as client:
        check_server(lightfit, client, flags.server)  # before the renders: they may take a while
        frame = scene.frame_current if flags.frame is None else flags.frame
        width, height = flags.size or default_size(scene)
        warn(lights, scene, width, height)
        readback = render_readback(scene, view_layer, lights, width, height, frame)
        if flags.keep_readback:
            keep_readback(readback, flags.keep_readback, frame)
        try:
            result = client.fit(
                readback.depth,
                readback.shadow,
                lightfit.Camera.from_blender(readback.camera_to_world, readback.projection),
                readback.lights,
                flags.map,
                clip=flags.clip.replace("-", "_"),
                facing=readback.facing,
                source=f"{bpy.data.filepath or 'untitled'}, scene {scene.name}, frame {frame}",
            )
        except lightfit.LightfitError as error:
            raise FitLightsError(f"--server {flags.server}: {error}") from None
    for light, fitted in zip(lights, result.lights):
        write_properties(light, fitted)
        print(line_about(fitted))
    if flags.json:
        write_json(result, flags.json)
    if flags.save:
        bpy.ops.wm.save_as_mainfile(filepath=os.path.abspath(flags.save), copy=True)
    without = [fitted.name for fitted in result.lights if not fitted.ok]
    if without:
        raise FitLightsError(f"no matrix for {', '.join(without)}: the lines above say why")


def parse_flags() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="blender -b SCENE.blend --python-exit-code 3 -P fit_lights.py --",
        description="Fit the light matrices of the open scene, with a server (lightfit serve).",
    )
    parser.add_argument(
        "--server",
        metavar="HOST:PORT",
        default="127.0.0.1:50071",
        help="where lightfit serve listens; several, with commas between; or unix:/PATH "
        "[127.0.0.1:50071]",
    )
    parser.add_argument(
        "--map",
        metavar="WIDTHxHEIGHT",
        type=size,
        default=(1024, 1024),
        help="size of every shadow map in texels [1024x1024]",
    )
    parser.add_argument(
        "--size",
        metavar="WIDTHxHEIGHT",
        type=size,
        help=f"size of the read-back in pixels [the scene's, scaled to {DEFAULT_WIDTH} across]",
    )
    parser.add_argument(
        "--clip",
        choices=("vulkan", "direct3d", "opengl", "reversed-z", "direct3d-reversed"),
        default="vulkan",
        help="clip space of lightfit_clip_from_world [vulkan]",
    )
    parser.add_argument(
        "--lights", metavar="NAME", nargs="+", help="these lights only [all that render, up to 32]"
    )
    parser.add_argument("--frame", metavar="N", type=int, help="which frame [the current one]")
    parser.add_argument("--json", metavar="OUT.json", help="write what lightfit fit --json writes")
    parser.add_argument("--save", metavar="OUT.blend", help="save the scene with the properties")
    parser.add_argument(
        "--keep-readback",
        metavar="DIR",
        help="write the read-back to DIR/FRAME.exr, lights and camera to DIR/FRAME.json",
    )
    parser.add_argument(
        "--demo", action="store_true", help="in place of the open scene, a small one from nothing"
    )
    arguments = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else []
    return parser.parse_args(arguments)


def size(text: str) -> Tuple[int, int]:
    try:
        width, height = (int(word) for word in text.split("x"))
    except ValueError:
        width = height = 0
    if min(width, height) < 1 or max(width, height) > 65536:
        raise argparse.ArgumentTypeError(f'"{text}", want WIDTHxHEIGHT such as 1024x1024')
    return width, height


def import_lightfit() -> Any:
    try:
        import lightfit
        import lightfit.client

        return lightfit
    except ImportError as error:
        raise FitLightsError(
            f"the Python package lightfit cannot be loaded ({error}): put it on PYTHONPATH, such "
            "as build/release/python, and see that Blender's Python has grpcio, protobuf and numpy "
            "(Debian: python3-grpcio python3-protobuf python3-numpy); other builds of Blender ask "
            "for --python-use-system-env"
        ) from None


def chosen_lights(
    scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer, names: List[str]
) -> List[bpy.types.Object]:
    """By name: the order of objects in a scene means nothing."""
    lights = sorted(rendered_lights(view_layer.layer_collection), key=lambda light: light.name)
    if not lights:
        raise FitLightsError(
            f'scene "{scene.name}", view layer "{view_layer.name}": has no light that renders, '
            "want a sun, a point light or a spot"
        )
    if names is None:
        return lights
    by_name = {light.name: light for light in lights}
    for name in names:
        if name not in by_name:
            raise FitLightsError(
                f'--lights {name}: no such light renders, want some of {", ".join(by_name)}'
            )
    return [by_name[name] for name in dict.fromkeys(names)]


def rendered_lights(layer_collection: bpy.types.LayerCollection) -> List[bpy.types.Object]:
    collection = layer_collection.collection
    if collection.hide_render:
        return []
    lights = set()
    if not layer_collection.exclude:
        lights.update(o for o in collection.objects if o.type == "LIGHT" and not o.hide_render)
    for child in layer_collection.children:
        lights.update(rendered_lights(child))
    return list(lights)


def default_size(scene: bpy.types.Scene) -> Tuple[int, int]:
    render = scene.render
    return DEFAULT_WIDTH, max(1, round(DEFAULT_WIDTH * render.resolution_y / render.resolution_x))


def warn(
    lights: List[bpy.types.Object], scene: bpy.types.Scene, width: int, height: int
) -> None:
    for light in lights:
        words = {
            "SPOT": "is a spot, fitted as a point light: its map covers shadows outside the cone, "
            "too",
            "AREA": "is an area light, fitted as a point light in its middle: shadows are hard",
        }.get(light.data.type)
        if words:
            print(f'fit_lights: warning: light "{light.name}": {words}')
        if light.library:
            print(
                f'fit_lights: warning: light "{light.name}": is linked from '
                f"{light.library.filepath}: its properties are not saved, take them from --json"
            )
    render = scene.render
    if abs(width * render.resolution_y / (height * render.resolution_x) - 1) > 0.02:
        print(
            f"fit_lights: warning: --size {width}x{height} has another shape than the scene's "
            f"{render.resolution_x}x{render.resolution_y}: it does not show the same"
        )


def check_server(lightfit: Any, client: Any, address: str) -> None:
    try:
        state = client.health()
    except lightfit.LightfitError as error:
        raise FitLightsError(
            f"--server {address}: {error}: is a server there? Start one with lightfit serve "
            "--listen HOST:PORT"
        ) from None
    if state != "SERVING":
        raise FitLightsError(f"--server {address}: says {state}: wait, or choose another server")


def keep_readback(readback: Readback, folder: str, frame: int) -> None:
    os.makedirs(folder, exist_ok=True)
    path = os.path.join(folder, f"{frame:04d}")
    readback.write_exr(f"{path}.exr")
    with open(f"{path}.json", "w", encoding="utf-8") as file:
        json.dump(readback.scene_file(), file, indent=1)
    print(f"fit_lights: kept {path}.exr; lightfit fit {path}.exr --lights {path}.json --camera "
          f"{path}.json --border lit fits it again")


def write_properties(light: bpy.types.Object, fitted: Any) -> None:
    """Matrices are 16 numbers, row-major. A light without one loses that of an earlier fit."""
    for name in PROPERTIES:
        light.pop(name, None)
    if not fitted.ok:
        return
    light["lightfit_map_from_world"] = fitted.map_from_world.ravel().tolist()
    light["lightfit_clip_from_world"] = fitted.clip_from_world.ravel().tolist()
    light["lightfit_map_size"] = list(fitted.map_size)
    light["lightfit_energy"] = fitted.energy


def line_about(fitted: Any) -> str:
    if not fitted.ok:
        return f"fit_lights: {fitted.name}: no matrix: {fitted.status}"
    width, height = fitted.map_size
    return (
        f"fit_lights: {fitted.name}: {width}x{height}, energy {fitted.energy:.4g}, one texel is "
        f"{fitted.footprint.rms:.3g} pixels of the read-back (rms of {fitted.samples.used} samples)"
    )


def write_json(result: Any, path: str) -> None:
    from google.protobuf import json_format

    with open(path, "w", encoding="utf-8") as file:
        file.write(json_format.MessageToJson(result.message, indent=1) + "\n")


if __name__ == "__main__":
    try:
        main()
    except (FitLightsError, SceneError):
        sys.tracebacklimit = 0  # Blender prints what is raised; the message says it all
        raise
