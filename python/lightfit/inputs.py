"""Cameras, lights and conventions, as callers write them and as messages."""

from __future__ import annotations

import codecs
import dataclasses
import json
import os
from pathlib import Path
from typing import Any, Dict, Mapping, Optional, Sequence, Tuple, Union

import numpy
from google.protobuf import json_format
from numpy.typing import ArrayLike

from lightfit.errors import InvalidArgumentError
from lightfit.v1 import camera_pb2, light_pb2, matrix_pb2, options_pb2, result_pb2
from lightfit.words import (
    CLIP_ALIASES,
    CLIPS,
    DEPTH_KIND_ALIASES,
    DEPTH_KINDS,
    check_fields,
    chosen,
    enum_word,
)

MAX_LIGHTS = 32

Clip = Union[str, matrix_pb2.ClipConvention]
# (width, height), texels; or as the command line has it, "1024x1024".
MapSize = Union[Tuple[int, int], str]
Options = Union[options_pb2.FitOptions, Mapping[str, Any]]
PlanOptions = Union[result_pb2.PlanOptions, Mapping[str, Any]]
Path_ = Union[str, "os.PathLike[str]"]


def clip_message(clip: Clip) -> matrix_pb2.ClipConvention:
    """clip: "vulkan", "direct3d" (also "metal", "webgpu"), "opengl", "reversed-z" (Vulkan's),
    "direct3d-reversed" (also "metal-reversed", "webgpu-reversed"), or a message."""
    if isinstance(clip, matrix_pb2.ClipConvention):
        return clip
    name = chosen("clip", clip, CLIPS, CLIP_ALIASES)
    depth_range, y_up = CLIPS[name]
    message = matrix_pb2.ClipConvention(y_up=y_up, name=name.replace("-", "_"))
    message.depth_range = depth_range  # type: ignore[assignment]
    return message


def depth_kind_number(kind: str) -> int:
    """kind: as `lightfit fit --depth-kind` has it."""
    return DEPTH_KINDS[chosen("depth_kind", kind, DEPTH_KINDS, DEPTH_KIND_ALIASES)]


def matrix_message(matrix: ArrayLike, field: str) -> matrix_pb2.Matrix4x4:
    """A (4, 4) matrix for column vectors: row-major, translation in the last column."""
    array = _numbers(matrix, field)
    if array.shape != (4, 4):
        raise InvalidArgumentError(f"{field}: has shape {array.shape}, want (4, 4)")
    bad = numpy.argwhere(~numpy.isfinite(array))
    if len(bad):
        row, column = bad[0]
        raise InvalidArgumentError(
            f"{field}[{row}, {column}] = {array[row, column]}, want 16 finite numbers"
        )
    return matrix_pb2.Matrix4x4(m=array.ravel().tolist())


def map_size_message(size: MapSize, field: str = "map_size") -> result_pb2.MapSize:
    """size: (width, height), texels; or "1024x1024"."""
    if isinstance(size, str):
        size = _size_of_words(size, field)
    try:
        width, height = (_whole_number(side) for side in size)
    except (TypeError, ValueError):
        raise InvalidArgumentError(
            f"{field} = {size!r}, want (width, height) in texels, such as (1024, 1024)"
        ) from None
    if width < 1 or height < 1 or max(width, height) > 2**31 - 1:
        raise InvalidArgumentError(f"{field} = {size!r}, want two numbers of texels >= 1")
    return result_pb2.MapSize(width=width, height=height)


def number_of_texels(texels: Union[int, str], field: str) -> int:
    """texels: a number, or a map that has so many, "4096x4096"."""
    if isinstance(texels, str):
        size = map_size_message(texels, field)
        return size.width * size.height
    try:
        return _whole_number(texels)
    except (TypeError, ValueError):
        raise InvalidArgumentError(
            f'{field} = {texels!r}, want a number of texels, such as 4 * 1024 * 1024 or "2048x2048"'
        ) from None


def options_message(options: Optional[Options]) -> Optional[options_pb2.FitOptions]:
    """options: a FitOptions message, or a dict of its fields.

    Words of an enum may be written short, and as the command line has them, in any case: {"search":
    "focused"} for "SEARCH_FOCUSED", {"metric": "l1-edge"} for "METRIC_L1_ACROSS_EDGE".
    """
    if options is None or isinstance(options, options_pb2.FitOptions):
        return options
    if not isinstance(options, Mapping):
        raise InvalidArgumentError(
            f"options: is a {type(options).__name__}, want a dict or lightfit.FitOptions"
        )
    check_fields("options", options, options_pb2.FitOptions.DESCRIPTOR)
    fields = {
        name: field
        for field in options_pb2.FitOptions.DESCRIPTOR.fields
        for name in (field.name, field.json_name)
    }
    full: Dict[str, Any] = {}
    for name, value in options.items():
        field = fields.get(name)
        if field is not None and field.enum_type is not None and isinstance(value, str):
            value = enum_word(field, value)
        full[name] = value
    message = options_pb2.FitOptions()
    try:
        json_format.ParseDict(full, message)
    except json_format.ParseError as error:
        raise InvalidArgumentError(f"options: {_one_line(error)}") from None
    return message


def plan_message(plan: Optional[PlanOptions]) -> result_pb2.PlanOptions:
    """plan: a PlanOptions message, or a dict of its fields, {"max_maps": 4, "each": (512, 512)}."""
    if isinstance(plan, result_pb2.PlanOptions):
        return plan
    if plan is not None and not isinstance(plan, Mapping):
        raise InvalidArgumentError(
            f"plan: is a {type(plan).__name__}, want a dict such as {{\"max_maps\": 4}} or "
            "lightfit.PlanOptions"
        )
    fields = dict(plan or {})
    check_fields("plan", fields, result_pb2.PlanOptions.DESCRIPTOR)
    each = fields.pop("each", None)
    if isinstance(fields.get("texels"), str):
        fields["texels"] = number_of_texels(fields["texels"], "plan: texels")
    message = result_pb2.PlanOptions()
    try:
        json_format.ParseDict(fields, message)
    except json_format.ParseError as error:
        raise InvalidArgumentError(f"plan: {_one_line(error)}") from None
    if each is not None:
        message.each.CopyFrom(map_size_message(each, "plan: each"))
    return message


@dataclasses.dataclass(frozen=True)
class Camera:
    """The camera of a read-back. `message` is the lightfit.v1.Camera; the size may be missing from
    it, and is that of the depth then."""

    message: camera_pb2.Camera

    @classmethod
    def from_matrices(
        cls,
        camera_from_world: ArrayLike,
        clip_from_camera: ArrayLike,
        *,
        clip: Clip,
        width: int = 0,
        height: int = 0,
        depth_kind: str = "camera-z",
    ) -> "Camera":
        """The matrices of an engine.

        camera_from_world: the view matrix, (4, 4), column vectors, rigid.
        clip_from_camera: the projection matrix, (4, 4), perspective or orthographic.
        clip: its convention, as for `fit`: "vulkan", "direct3d", "opengl", "reversed-z",
            "direct3d-reversed". With OpenGL's depth in 0 ... 1 that of Direct3D.
        width, height: of the read-back, pixels; 0: as the depth's.
        depth_kind: what depth values are: "camera-z" (planar distance in front of the camera, world
            units), "distance" (along the ray), "ndc-0-1", "ndc-minus-1-1", "ndc-reversed"; in any
            case, and "-" or "_" between.
        """
        camera = camera_pb2.Camera(
            width=width,
            height=height,
            camera_from_world=matrix_message(camera_from_world, "camera_from_world"),
            clip_from_camera=matrix_message(clip_from_camera, "clip_from_camera"),
            clip=clip_message(clip),
            depth_kind=depth_kind_number(depth_kind),  # type: ignore[arg-type]
        )
        return cls(camera)

    @classmethod
    def from_blender(
        cls,
        matrix_world: ArrayLike,
        projection: ArrayLike,
        *,
        width: int = 0,
        height: int = 0,
        depth_kind: str = "camera-z",
    ) -> "Camera":
        """Blender's `camera.matrix_world` and `camera.calc_matrix_camera(...)`; and camera_to_world
        and projection of the scene files that `lightfit fit --camera` reads."""
        camera = camera_pb2.Camera(
            width=width,
            height=height,
            world_from_camera=matrix_message(matrix_world, "matrix_world"),
            clip_from_camera=matrix_message(projection, "projection"),
            clip=clip_message("opengl"),
            depth_kind=depth_kind_number(depth_kind),  # type: ignore[arg-type]
        )
        return cls(camera)


@dataclasses.dataclass(frozen=True)
class Light:
    """A point light or a directional light."""

    name: str
    position: Optional[Tuple[float, ...]] = None
    direction: Optional[Tuple[float, ...]] = None

    @classmethod
    def point(cls, name: str, position: ArrayLike) -> "Light":
        """position: 3 numbers, world units."""
        return cls(name, position=_triple(position, f'light "{name}": position'))

    @classmethod
    def sun(cls, name: str, direction: ArrayLike) -> "Light":
        """direction: in which the light travels, 3 numbers of any length."""
        return cls(name, direction=_triple(direction, f'light "{name}": direction'))

    @property
    def message(self) -> light_pb2.Light:
        return light_pb2.Light(
            name=self.name, position=self.position or (), direction=self.direction or ()
        )


AnyCamera = Union[Camera, camera_pb2.Camera]
AnyLight = Union[Light, light_pb2.Light, Mapping[str, Any]]
# A sequence of lights, or the path of a lights file (JSON, as `lightfit fit --lights`).
Lights = Union[Sequence[AnyLight], Path_]


def camera_message(camera: AnyCamera, width: int, height: int) -> camera_pb2.Camera:
    """The camera of a read-back of width x height pixels."""
    message = camera.message if isinstance(camera, Camera) else camera
    if not isinstance(message, camera_pb2.Camera):
        raise InvalidArgumentError(
            f"camera: is a {type(camera).__name__}, want lightfit.Camera, such as "
            "Camera.from_matrices(camera_from_world, clip_from_camera, clip=\"opengl\")"
        )
    if message.width == 0 and message.height == 0:
        sized = camera_pb2.Camera(width=width, height=height)
        sized.MergeFrom(message)
        message = sized
    if (message.width, message.height) != (width, height):
        raise InvalidArgumentError(
            f"camera: is {message.width} x {message.height} pixels and depth has shape "
            f"{(height, width)}, want the same size (shape is (height, width))"
            + (": depth.T" if (message.height, message.width) == (width, height) else "")
        )
    return message


def light_messages(lights: Lights) -> Tuple[light_pb2.Light, ...]:
    """1 to 32 lights. What is wrong with one light alone is left to its status."""
    if isinstance(lights, (str, os.PathLike)):
        messages = _lights_of_file(Path(lights))
    elif isinstance(lights, (Light, light_pb2.Light, Mapping)):
        raise InvalidArgumentError("lights: is one light, want a list of them: [light]")
    else:
        messages = tuple(_light_message(light, index) for index, light in enumerate(lights))
    if not 1 <= len(messages) <= MAX_LIGHTS:
        raise InvalidArgumentError(
            f"lights: {len(messages)} of them, want 1 to {MAX_LIGHTS}: one shadow bit each"
        )
    return messages


def _light_message(light: AnyLight, index: int) -> light_pb2.Light:
    if isinstance(light, Light):
        return light.message
    if isinstance(light, light_pb2.Light):
        return light
    if not isinstance(light, Mapping):
        raise InvalidArgumentError(
            f"lights[{index}]: is a {type(light).__name__}, want lightfit.Light or a dict such as "
            '{"name": "key", "position": [3, 1, 4]}'
        )
    message = light_pb2.Light()
    try:
        json_format.ParseDict(dict(light), message)
    except json_format.ParseError as error:
        raise InvalidArgumentError(f"lights[{index}]: {_one_line(error)}") from None
    return message


def _decoded(data: bytes) -> str:
    """Text as other systems write it: UTF-8 with a mark, UTF-16. As base/text_encoding.h."""
    if data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return data.decode("utf-16")
    return data.decode("utf-8-sig")


_POINTS = {"point", "spot", "omni", "sphere", "photometric"}
_SUNS = {"sun", "directional", "direction", "distant", "infinite"}


def _as_light(fields: Any) -> Any:
    """An entry of a lights file, as io/lights_file.h understands it: of a spot the position, of a
    sun the direction; of what has neither, such as a dome or an area, the name, which fails
    alone."""
    if not isinstance(fields, dict):
        return fields
    words = [fields.get(name) for name in ("type", "kind", "light_type", "lightType")]
    said = next((word for word in words if word not in (None, "")), None)
    bare = "".join(c for c in str(said).lower() if "a" <= c <= "z")
    bare = bare[3:] if bare.startswith("pxr") and len(bare) > 3 else bare
    if len(bare) > 5:
        bare = bare[:-5] if bare.endswith("light") else bare
        bare = bare[5:] if bare.startswith("light") else bare
    unused = set()
    if said is not None and bare not in _POINTS | _SUNS:
        unused = {"position", "direction"}
    elif fields.get("position") and fields.get("direction"):
        unused = {"position"} if bare in _SUNS else {"direction"}
    return {name: value for name, value in fields.items() if name not in unused}


def _lights_of_file(path: Path) -> Tuple[light_pb2.Light, ...]:
    try:
        text = _decoded(path.read_bytes())
    except OSError as error:
        raise InvalidArgumentError(f"lights: {path}: {error.strerror}") from None
    except UnicodeDecodeError:
        raise InvalidArgumentError(f"lights: {path}: is not a text file, want JSON") from None
    try:
        fields = json.loads(text)
        if not isinstance(fields, dict):
            raise json_format.ParseError("is no object")
        if isinstance(fields.get("lights"), list):
            fields["lights"] = [_as_light(light) for light in fields["lights"]]
        parsed = light_pb2.LightList()
        json_format.ParseDict(fields, parsed, ignore_unknown_fields=True)
    except (json.JSONDecodeError, json_format.ParseError) as error:
        raise InvalidArgumentError(
            f'lights: {path}: {_one_line(error)}; want {{"lights": [{{"name": "key", "position": '
            "[x, y, z]}]}"
        ) from None
    return tuple(parsed.lights)


def _triple(values: ArrayLike, field: str) -> Tuple[float, ...]:
    array = _numbers(values, field)
    if array.shape != (3,):
        raise InvalidArgumentError(f"{field}: has shape {array.shape}, want 3 numbers")
    return tuple(array.tolist())


def _numbers(values: ArrayLike, field: str) -> "numpy.typing.NDArray[numpy.float64]":
    try:
        return numpy.asarray(values, dtype=numpy.float64)
    except (TypeError, ValueError):
        raise InvalidArgumentError(f"{field} = {values!r}, want numbers") from None


def _size_of_words(size: str, field: str) -> Tuple[int, int]:
    words = size.strip().lower().split("x")
    if len(words) == 2 and all(word.strip().isdecimal() for word in words):
        return int(words[0]), int(words[1])
    raise InvalidArgumentError(f'{field} = {size!r}, want WIDTHxHEIGHT such as "1024x1024"')


def _whole_number(value: Any) -> int:
    if int(value) != value:
        raise ValueError(value)
    return int(value)


def _one_line(error: Exception) -> str:
    return " ".join(str(error).split())
