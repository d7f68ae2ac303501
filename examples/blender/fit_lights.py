"""Fits the light matrices of the open scene: renders a read-back, asks a lightfit server, and
writes the matrices onto the lights.

    lightfit serve &
    blender -b SCENE.blend --python-exit-code 3 -P fit_lights.py -- --json matrices.json

`-- --help` lists the options; README.md says what becomes of the lights.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import sys
from typing import Any, List, Optional, Tuple

import bpy
from mathutils import Vector

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
    check_outputs(flags)  # before the renders, as the server below
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


def check_outputs(flags: argparse.Namespace) -> None:
    """That --json, --save and --keep-readback can be written: a render may take a while."""
    for flag, path in (("--json", flags.json), ("--save", flags.save)):
        if path:
            check_writable(flag, os.path.abspath(path))
    if flags.keep_readback:
        folder = os.path.abspath(flags.keep_readback)
        try:
            os.makedirs(folder, exist_ok=True)
        except OSError as error:
            raise FitLightsError(f"--keep-readback {folder}: {error.strerror}") from None
        check_writable("--keep-readback", os.path.join(folder, "frame.exr"))


def check_writable(flag: str, path: str) -> None:
    folder = os.path.dirname(path)
    if os.path.isdir(path):
        raise FitLightsError(f"{flag} {path}: is a folder, want a file")
    if not os.path.isdir(folder):
        raise FitLightsError(f"{flag} {path}: there is no folder {folder}")
    # A file that is there is what counts, else whether its folder takes one.
    if not os.access(path if os.path.exists(path) else folder, os.W_OK):
        raise FitLightsError(f"{flag} {path}: cannot be written: no permission")


def warn(
    lights: List[bpy.types.Object], scene: bpy.types.Scene, width: int, height: int
) -> None:
    for light in lights:
        for words in cautions(light):
            print(f'fit_lights: warning: light "{light.name}": {words}')
    for name, collection in linked_lights(scene):
        print(
            f'fit_lights: warning: light "{name}": is in the linked collection '
            f'"{collection}" and not fitted: make it local (Object > Relations > Make Instances '
            "Real)"
        )
    render = scene.render
    if abs(width * render.resolution_y / (height * render.resolution_x) - 1) > 0.02:
        print(
            f"fit_lights: warning: --size {width}x{height} has another shape than the scene's "
            f"{render.resolution_x}x{render.resolution_y}: it does not show the same"
        )


# Beyond these a penumbra is wider than a shadow map is worth: the real sun has half a degree.
HARD_SUN_DEG = 1.0
HARD_POINT_SHARE = 0.02  # radius, of the distance to the nearest thing that is rendered


def cautions(light: bpy.types.Object) -> List[str]:
    """What of the light its map does not have."""
    found = []
    data = light.data
    if data.type == "SPOT":
        found.append(
            "is a spot, fitted as a point light: its map covers shadows outside the cone, too"
        )
    if data.type == "AREA":
        found.append("is an area light, fitted as a point light in its middle: shadows are hard")
    if data.type == "SUN" and math.degrees(data.angle) > HARD_SUN_DEG:
        found.append(
            f"is a soft sun of {math.degrees(data.angle):.3g} degrees, fitted as a hard one: its "
            "map is right where shadows touch what casts them"
        )
    if data.type in ("POINT", "SPOT") and data.shadow_soft_size > 0:
        distance = nearest_distance(light)
        if distance is not None and data.shadow_soft_size > HARD_POINT_SHARE * distance:
            found.append(
                f"has a radius of {data.shadow_soft_size:.3g}, {distance:.3g} from the nearest "
                "thing, fitted as a point: its shadows are softer than its map"
            )
    if light.library:
        found.append(
            f"is linked from {light.library.filepath}: its properties are not saved, take them "
            "from --json"
        )
    return found


def nearest_distance(light: bpy.types.Object) -> Optional[float]:
    """To the boxes around what renders, scene units; None where there is nothing or it is inside
    of all."""
    place = light.matrix_world.translation
    nearest = None
    for thing in bpy.context.scene.objects:
        if thing.type not in ("MESH", "CURVE", "SURFACE", "FONT", "META") or thing.hide_render:
            continue
        corners = [thing.matrix_world @ Vector(corner) for corner in thing.bound_box]
        low = [min(corner[axis] for corner in corners) for axis in range(3)]
        high = [max(corner[axis] for corner in corners) for axis in range(3)]
        beyond = [max(low[axis] - place[axis], 0.0, place[axis] - high[axis]) for axis in range(3)]
        distance = math.sqrt(sum(part * part for part in beyond))
        if distance > 0.0 and (nearest is None or distance < nearest):
            nearest = distance
    return nearest


def linked_lights(scene: bpy.types.Scene) -> List[Tuple[str, str]]:
    """Lights that render inside of collection instances: (light, collection)."""
    found = []
    for thing in scene.objects:
        collection = thing.instance_collection if thing.instance_type == "COLLECTION" else None
        if collection is None or thing.hide_render:
            continue
        for inside in collection.all_objects:
            if inside.type == "LIGHT" and not inside.hide_render:
                found.append((inside.name, collection.name))
    return sorted(set(found))


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
