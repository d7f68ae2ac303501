"""Runs inside Blender.

blender -b SCENE.blend -P blender_scene.py -- OUT.json SCENE.obj
    writes what the scene is (all settings, lights and their properties) and its meshes.
blender -b -P blender_scene.py
    checks that a read-back leaves the demo scene as it was.
"""

from __future__ import annotations

import json
import os
import sys

import bpy

EXAMPLE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../examples/blender")
sys.path.insert(0, EXAMPLE)

import demo_scene
import readback

_PLAIN = ("BOOLEAN", "INT", "FLOAT", "STRING", "ENUM")


def settings_of(data) -> dict:
    """Every plain setting of a block of data, without the count of its users: Blender loses track
    of that when scenes are copied, and counts anew whenever it reads a file."""
    settings = {}
    for name, prop in data.bl_rna.properties.items():
        if name != "users" and prop.type in _PLAIN and hasattr(data, name):
            value = getattr(data, name)
            settings[name] = repr(value[:] if getattr(prop, "is_array", False) else value)
    return settings


def describe() -> dict:
    scene = bpy.context.scene
    return {
        "scene": {name: settings_of(part) for name, part in (
            ("scene", scene), ("render", scene.render), ("cycles", scene.cycles),
            ("image", scene.render.image_settings))},
        "layers": {
            layer.name: {"layer": settings_of(layer), "override": repr(layer.material_override),
                         "groups": [group.name for group in layer.lightgroups]}
            for layer in scene.view_layers
        },
        "world": repr(scene.world),
        "frame": scene.frame_current,
        "objects": {
            o.name: {"object": settings_of(o), "data": settings_of(o.data) if o.data else {}}
            for o in scene.objects
        },
        "blocks": {
            kind: sorted(block.name for block in getattr(bpy.data, kind))
            for kind in ("scenes", "objects", "lights", "materials", "worlds", "meshes", "cameras")
        },
        "properties": {
            o.name: {key: value.to_list() if hasattr(value, "to_list") else value
                     for key, value in o.items() if key.startswith("lightfit")}
            for o in scene.objects if o.type == "LIGHT"
        },
    }


def check_that_all_is_restored() -> None:
    """After a read-back, and after one that fails half-way."""
    scene, layer = bpy.context.scene, bpy.context.view_layer
    lights = [o for o in scene.objects if o.type == "LIGHT"]
    before = describe()
    readback.render_readback(scene, layer, lights, 32, 18, frame=25)
    check_same(describe(), before)
    scene.camera.data.type = "PANO"
    before = describe()
    try:
        readback.render_readback(scene, layer, lights, 32, 18, frame=25)
        raise AssertionError("a panoramic camera was taken")
    except readback.SceneError:
        check_same(describe(), before)


def check_same(after, before, name: str = "") -> None:
    if isinstance(before, dict) and isinstance(after, dict) and before.keys() == after.keys():
        for key in before:
            check_same(after[key], before[key], f"{name}/{key}")
    elif after != before:
        raise AssertionError(f"{name}: was {before}, is {after}")


def main() -> None:
    if not bpy.data.filepath:
        demo_scene.make_demo_scene()
        check_that_all_is_restored()
        return
    arguments = sys.argv[sys.argv.index("--") + 1 :]
    with open(arguments[0], "w") as file:
        json.dump(describe(), file)
    for o in bpy.context.scene.objects:
        o.select_set(o.type == "MESH")
    bpy.ops.wm.obj_export(
        filepath=arguments[1],
        export_selected_objects=True,
        export_materials=False,
        forward_axis="Y",
        up_axis="Z",
    )


main()
