"""The read-back of a scene: depth, and per light a shadow bit and one that says which surfaces face
it, rendered with Cycles.

A light's shadow is the quotient of two renders that differ in nothing but whether lights cast
shadows; a light group of its own keeps it apart from the other lights. All samples of a pixel lie
at its centre, where Cycles takes depth, too; so the quotient is 0 or 1, and fits the depth. The
render without shadows is dark where a surface is turned away.

Everything happens in a copy of the scene, with lights of its own in the places of the scene's. The
copy goes when it is done, whatever happens; meanwhile the scene's lights are hidden and its camera
has no depth of field.
"""

from __future__ import annotations

import contextlib
import dataclasses
import json
import math
import os
import tempfile
from typing import Any, Dict, Iterator, List, Sequence

import bpy
import numpy
from exr_file import read_exr, write_exr

MAX_LIGHTS = 32  # one shadow bit each


class SceneError(Exception):
    """The scene cannot be rendered; the message says the way out."""


@dataclasses.dataclass(frozen=True)
class Readback:
    depth: numpy.ndarray  # (h, w) float32, planar distance, scene units; 1e10 where nothing was hit
    shadow: numpy.ndarray  # (h, w) uint32, light l in bit l; 0 where a surface faces away from it
    facing: numpy.ndarray  # likewise, 1 where it faces the light
    lights: List[Dict[str, Any]]  # {"name", "position"} or {"name", "direction"}
    camera_to_world: numpy.ndarray  # (4, 4), of the camera; it looks along -z
    projection: numpy.ndarray  # (4, 4), as OpenGL's: y up, depth -1 ... 1
    pixel_aspect: float  # width over height of a pixel

    def scene_file(self) -> Dict[str, Any]:
        """Lights and camera, for `lightfit fit --lights FILE --camera FILE`."""
        height, width = self.depth.shape
        return {
            "width": width,
            "height": height,
            "lights": self.lights,
            "frames": [
                {
                    "camera_to_world": self.camera_to_world.tolist(),
                    "projection": self.projection.tolist(),
                }
            ],
        }

    def write_exr(self, path: str) -> None:
        """Depth, shadows, facing, lights and camera, for `lightfit fit FILE`. The camera in the
        header has single precision only; that of scene_file() is the exact one."""
        channels = {"Z": self.depth}
        for bit, light in enumerate(self.lights):
            for kind, words in (("shadow", self.shadow), ("facing", self.facing)):
                values = (words >> numpy.uint32(bit)) & 1
                channels[f"{kind}.{light['name']}"] = values.astype(numpy.float16)
        # The standard's camera looks along +z, and its NDC is (0, 0) in the upper left corner.
        camera_from_world = numpy.linalg.inv(self.camera_to_world)
        ndc_from_clip = numpy.diag([0.5, -0.5, 1.0, 1.0])
        ndc_from_clip[:2, 3] = 0.5
        matrices = {
            "worldToCamera": numpy.diag([1.0, 1.0, -1.0, 1.0]) @ camera_from_world,
            "worldToNDC": ndc_from_clip @ self.projection @ camera_from_world,
        }
        strings = {"lightfit.lights": json.dumps({"lights": self.lights})}
        write_exr(path, channels, matrices, self.pixel_aspect, strings)


def render_readback(
    scene: bpy.types.Scene,
    view_layer: bpy.types.ViewLayer,
    lights: Sequence[bpy.types.Object],
    width: int,
    height: int,
    frame: int,
) -> Readback:
    """lights: at most MAX_LIGHTS, suns; all others are taken as points. Raises SceneError."""
    _check(scene, lights)
    with _copy_of(scene, view_layer) as copy, _stand_ins(scene, copy, lights) as stand_ins:
        layer = copy.view_layers[0]
        for number, stand_in in enumerate(stand_ins):
            stand_in.lightgroup = layer.lightgroups.add(name=_group(number)).name
        _set_up(copy, width, height, len(lights))
        copy.frame_set(frame)
        depsgraph = layer.depsgraph
        camera = copy.camera  # of this frame: markers may switch it
        _check_camera(camera)
        render = copy.render
        projection = camera.calc_matrix_camera(
            depsgraph,
            x=width,
            y=height,
            scale_x=render.pixel_aspect_x,
            scale_y=render.pixel_aspect_y,
        )
        places = [numpy.array(light.evaluated_get(depsgraph).matrix_world) for light in stand_ins]
        with _set_to(False, "use_dof", [camera.data.dof]):
            lit = _render(copy, stand_ins, cast_shadow=False)
            seen = _render(copy, stand_ins, cast_shadow=True)
        shadow = numpy.zeros((height, width), numpy.uint32)
        facing = numpy.zeros_like(shadow)
        for number in range(len(lights)):
            full = _channel(lit, f"Combined_{_group(number)}.R")
            part = _channel(seen, f"Combined_{_group(number)}.R")
            shadow |= (part < 0.5 * full).astype(numpy.uint32) << numpy.uint32(number)
            facing |= (full > 0).astype(numpy.uint32) << numpy.uint32(number)
        return Readback(
            depth=_channel(seen, "Depth.Z"),
            shadow=shadow,
            facing=facing,
            lights=[
                _light_entry(light, place, stand_in.data.type)
                for light, place, stand_in in zip(lights, places, stand_ins)
            ],
            camera_to_world=numpy.array(
                camera.evaluated_get(depsgraph).matrix_world.normalized(), numpy.float64
            ),
            projection=numpy.array(projection, numpy.float64),
            pixel_aspect=render.pixel_aspect_x / render.pixel_aspect_y,
        )


def _check(scene: bpy.types.Scene, lights: Sequence[bpy.types.Object]) -> None:
    if "lightgroups" not in bpy.types.ViewLayer.bl_rna.properties:
        raise SceneError(f"Blender {bpy.app.version_string} has no light groups, want 3.2 or later")
    if not hasattr(scene, "cycles"):
        raise SceneError("Cycles is off, want the add-on Cycles Render Engine enabled")
    if scene.camera is None:
        raise SceneError(f'scene "{scene.name}" has no camera: set one in Scene Properties, Camera')
    if len(lights) > MAX_LIGHTS:
        raise SceneError(
            f"{len(lights)} lights, want at most {MAX_LIGHTS}: choose some with --lights NAME ..."
        )


def _check_camera(camera: bpy.types.Object) -> None:
    if camera.type != "CAMERA" or camera.data.type == "PANO":
        raise SceneError(
            f'camera "{camera.name}": is panoramic or no camera at all, want a perspective or an '
            "orthographic one: a read-back has one projection"
        )


@contextlib.contextmanager
def _copy_of(scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer) -> Iterator[bpy.types.Scene]:
    """The scene with that view layer alone."""
    copy = scene.copy()
    try:
        for layer in copy.view_layers[:]:
            if layer.name != view_layer.name:
                copy.view_layers.remove(layer)
        yield copy
    finally:
        bpy.data.scenes.remove(copy)


@contextlib.contextmanager
def _set_to(value: Any, name: str, blocks: Sequence[Any]) -> Iterator[None]:
    """A setting of some blocks of data, which get their own back afterwards."""
    before = [getattr(block, name) for block in blocks]
    try:
        for block in blocks:
            setattr(block, name, value)
        yield
    finally:
        for block, own in zip(blocks, before):
            setattr(block, name, own)


@contextlib.contextmanager
def _stand_ins(
    scene: bpy.types.Scene, copy: bpy.types.Scene, lights: Sequence[bpy.types.Object]
) -> Iterator[List[bpy.types.Object]]:
    """Lights without size, colour, cone or animation, that follow `lights`; others are hidden."""
    others = [o for o in scene.objects if o.type == "LIGHT"]
    stand_ins: List[bpy.types.Object] = []
    try:
        for light in lights:
            is_sun = light.data.type == "SUN"
            data = bpy.data.lights.new("lightfit", "SUN" if is_sun else "POINT")
            data.energy = 1.0 if is_sun else 1000.0  # any will do
            data.shadow_soft_size = 0.0
            if is_sun:
                data.angle = 0.0
            stand_in = bpy.data.objects.new("lightfit", data)
            stand_ins.append(stand_in)
            copy.collection.objects.link(stand_in)
            stand_in.constraints.new("COPY_TRANSFORMS").target = light
        with _set_to(True, "hide_render", others):
            yield stand_ins
    finally:
        for stand_in in stand_ins:
            data = stand_in.data
            bpy.data.objects.remove(stand_in)
            bpy.data.lights.remove(data)


def _set_up(copy: bpy.types.Scene, width: int, height: int, num_lights: int) -> None:
    render, cycles, layer = copy.render, copy.cycles, copy.view_layers[0]
    render.engine = "CYCLES"
    render.resolution_x, render.resolution_y, render.resolution_percentage = width, height, 100
    for name in (
        "border",
        "compositing",
        "freestyle",
        "motion_blur",
        "multiview",
        "placeholder",
        "sequencer",
        "stamp",
    ):
        setattr(render, f"use_{name}", False)
    render.use_overwrite = True
    render.image_settings.file_format = "OPEN_EXR_MULTILAYER"
    render.image_settings.color_depth = "32"
    render.image_settings.exr_codec = "NONE"
    copy.world = None  # sky lights shadows, too
    copy.use_nodes = False

    # A sample sees one light. The first 2^k samples of a pixel are spread evenly over the lights:
    # each of 2^k equal parts of their list has one. So none is missed with twice as many samples.
    cycles.samples = 2 * 2 ** math.ceil(math.log2(num_lights))
    layer.samples = 0  # as the scene
    cycles.use_adaptive_sampling = False
    cycles.use_denoising = False
    cycles.time_limit = 0.0
    cycles.light_sampling_threshold = 0.0  # or far lights would be left out at random
    cycles.sample_clamp_direct = 0.0
    cycles.pixel_filter_type = "GAUSSIAN"  # a box is always one pixel wide
    cycles.filter_width = 0.01  # pixels
    cycles.max_bounces = 0
    cycles.seed, cycles.use_animated_seed = 0, False

    layer.use = True
    layer.use_pass_combined = layer.use_pass_z = True


@contextlib.contextmanager
def _diffuse(layer: bpy.types.ViewLayer) -> Iterator[None]:
    """Every surface opaque and white."""
    material = bpy.data.materials.new("lightfit")
    try:
        material.use_nodes = True
        nodes = material.node_tree.nodes
        nodes.clear()
        surface = nodes.new("ShaderNodeBsdfDiffuse").outputs[0]
        target = nodes.new("ShaderNodeOutputMaterial").inputs["Surface"]
        material.node_tree.links.new(surface, target)
        layer.material_override = material
        yield
    finally:
        bpy.data.materials.remove(material)


def _render(
    copy: bpy.types.Scene, stand_ins: Sequence[bpy.types.Object], *, cast_shadow: bool
) -> Dict[str, numpy.ndarray]:
    """The channels of a render."""
    for stand_in in stand_ins:
        stand_in.data.cycles.cast_shadow = cast_shadow
    with tempfile.TemporaryDirectory() as folder, _diffuse(copy.view_layers[0]):
        copy.render.filepath = os.path.join(folder, "readback.exr")
        bpy.ops.render.render(scene=copy.name, write_still=True)
        return read_exr(copy.render.filepath)


def _channel(channels: Dict[str, numpy.ndarray], end: str) -> numpy.ndarray:
    """Blender puts the name of the view layer first."""
    return next(array for name, array in channels.items() if name.endswith("." + end))


def _group(number: int) -> str:
    return f"lightfit{number:02d}"


def _light_entry(light: bpy.types.Object, place: numpy.ndarray, kind: str) -> Dict[str, Any]:
    """place: world from light; a sun shines along its -z."""
    if kind == "SUN":
        direction = -place[:3, 2] / numpy.linalg.norm(place[:3, 2])
        return {"name": light.name, "direction": direction.tolist()}
    return {"name": light.name, "position": place[:3, 3].tolist()}
