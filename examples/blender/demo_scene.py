"""A small scene from nothing: a floor, boxes and a ball; a sun, a point light and a spot.

Its soft lights, sky, depth of field and motion blur are what scenes have and read-backs do without.
"""

from __future__ import annotations

import math

import bpy
from mathutils import Vector

_BOXES = (  # centre on the floor, size, turn in degrees; metres, z up
    ((-2.0, 1.0), (1.0, 1.0, 2.0), 20.0),
    ((0.5, 2.5), (1.5, 0.6, 1.2), -35.0),
    ((1.8, -0.5), (0.7, 0.7, 0.7), 50.0),
    ((-0.6, -1.2), (0.5, 0.9, 0.5), 10.0),
)


def make_demo_scene() -> None:
    """In the place of what is open. The sun moves from frame 1 to 25."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    bpy.ops.mesh.primitive_plane_add(size=14.0)
    bpy.context.object.name = "floor"
    for number, ((x, y), size, turn_deg) in enumerate(_BOXES):
        bpy.ops.mesh.primitive_cube_add(
            size=1.0, location=(x, y, size[2] / 2), rotation=(0, 0, math.radians(turn_deg))
        )
        bpy.context.object.scale = size
        bpy.context.object.name = f"box{number}"
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=3, radius=0.4, location=(0.6, -1.8, 0.4))
    bpy.context.object.name = "ball"

    sun = _add_light("sun", "SUN", location=(0, 0, 8), target=(4.0, 2.0, 0.0))
    sun.data.energy = 3.0
    sun.data.angle = math.radians(5.0)
    sun.keyframe_insert("rotation_euler", frame=1)
    sun.rotation_euler.rotate_axis("X", math.radians(20.0))
    sun.keyframe_insert("rotation_euler", frame=25)

    hook = bpy.data.objects.new("hook", None)
    hook.location = (2.0, -2.5, 0.0)
    scene.collection.objects.link(hook)
    lamp = _add_light("lamp", "POINT", location=(0.5, -0.5, 3.0), target=(0, 0, 0))
    lamp.data.energy = 400.0
    lamp.data.shadow_soft_size = 0.25
    lamp.data.color = (0.1, 0.4, 1.0)
    lamp.parent = hook

    spot = _add_light("spot", "SPOT", location=(-4.0, -3.0, 4.0), target=(0, 0.5, 0))
    spot.data.energy = 800.0

    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    scene.collection.objects.link(camera)
    camera.location = (1.0, -7.0, 3.2)
    camera.rotation_euler = _aim(camera.location, (-0.2, 0.4, 0.5))
    camera.data.dof.use_dof = True
    camera.data.dof.focus_distance = 5.0
    camera.data.dof.aperture_fstop = 0.5
    scene.camera = camera

    scene.world = bpy.data.worlds.new("sky")
    scene.render.use_motion_blur = True
    scene.render.resolution_x, scene.render.resolution_y = 1920, 1080
    scene.frame_set(1)


def _add_light(name: str, kind: str, location: tuple, target: tuple) -> bpy.types.Object:
    light = bpy.data.objects.new(name, bpy.data.lights.new(name, kind))
    bpy.context.scene.collection.objects.link(light)
    light.location = location
    light.rotation_euler = _aim(location, target)
    return light


def _aim(location: tuple, target: tuple):
    """Turns that let -z point from `location` to `target`."""
    return (Vector(target) - Vector(location)).to_track_quat("-Z", "Y").to_euler()
