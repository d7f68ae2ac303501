"""Read-backs from OpenEXR files, read by the library itself, as `lightfit fit` reads them."""

from __future__ import annotations

import dataclasses
import os
import warnings
from typing import Any, Dict, List, Mapping, Optional, Tuple

import numpy
from numpy.typing import NDArray

from lightfit import _load
from lightfit.cover import FineCover
from lightfit.errors import LightfitWarning
from lightfit.inputs import AnyCamera, Camera, Lights, Path_, depth_kind_number, light_messages
from lightfit.request import ReadbackParts, readback_parts
from lightfit.v1 import camera_pb2, light_pb2, result_pb2


Planes = Tuple[Optional[NDArray[numpy.bool_]], ...]


@dataclasses.dataclass(frozen=True, eq=False)
class ExrReadback:
    """The first four arguments of `fit`: depth, shadow, camera, lights; and facing and mapped."""

    depth: NDArray[numpy.float32]  # (h, w), the file's display window
    shadow: NDArray[numpy.uint32]  # (h, w), light l in bit l
    camera: Camera
    lights: Tuple[light_pb2.Light, ...]
    light_status: List[result_pb2.Status]  # of each: code 0, or why its channels cannot be read
    path: str
    origin: result_pb2.ReadbackOrigin  # the channel, parts and view that were taken

    # One plane per light, (h, w) bool, None where the file has none of it; None: of no light.
    facing: Optional[Planes] = None  # True where the surface faces the light
    mapped: Optional[Planes] = None  # True where the map that is drawn with says shadow

    cover: Optional[FineCover] = None  # of a second, larger file

    # At and beyond this depth nothing was hit, as stated or found; math.inf: nowhere before 1e9.
    background: Optional[float] = None

    def parts(self) -> ReadbackParts:
        return readback_parts(
            self.depth,
            self.shadow,
            self.camera,
            self.lights,
            self.path,
            self.facing,
            self.mapped,
            self.cover,
            self.background,
        )


def read_exr(
    path: Path_,
    lights: Lights,
    *,
    camera: Optional[AnyCamera] = None,
    camera_convention: str = "",
    near: Optional[float] = None,
    far: Optional[float] = None,
    pixel_aspect: Optional[float] = None,
    depth_kind: Optional[str] = None,
    depth_channel: str = "",
    shadow_channel: str = "",
    shadow_channels: Optional[Mapping[str, str]] = None,
    shadow_bits_channel: str = "",
    facing_channel: str = "",
    mapped_channel: str = "",
    cover: Optional[Path_] = None,
    view: str = "",
    background: Optional[float] = None,
) -> ExrReadback:
    """Reads depth, shadows, camera, and what there is of facing and mapped.

    path: the file. lights: as for `fit`.
    camera: instead of the attributes worldToCamera and worldToNDC of the file.
    camera_convention: who wrote those: "openexr", "mantra" or "pbrt"; words such as
        "column-vectors,y-up" change it.
    near, far: clip planes, world units; needed for NDC depth only.
    pixel_aspect: width over height of a pixel. None: as the file says.
    depth_kind: as for Camera.from_matrices. None: as the camera says, or else "camera-z".
    depth_channel: the best of "Z", "depth", "ViewLayer.Depth.Z", "depth.V" and the like, unless
        given. This and the names below are CHANNEL, or PART.CHANNEL of a file of several parts.
    shadow_channel: the name of the shadow channels, "shadow.{light}" unless given; a light is
        blocked above 0.5.
    shadow_channels: light name to channel name, for lights that do not follow that.
    shadow_bits_channel: instead, one UINT channel that holds all shadows, light l in bit l.
    facing_channel: the name of the channels that say which surfaces face a light,
        "facing.{light}" unless given; they do above 0.5. Lights need not have one.
    mapped_channel: likewise, "mapped.{light}" unless given: what the map that is drawn with says,
        shadow above 0.5.
    cover: a second file, the same frame with more pixels, as `lightfit fit --cover-readback`: its
        channels have the same names, and its camera is the read-back's.
    view: the view of a stereo file that depth, shadows and camera are of. "": the only one that
        has a depth.
    background: as for `fit`.

    What in the file may be a mistake, as lights that differ from those in its header, is a
    LightfitWarning.

    Raises InvalidArgumentError when the file, its depth or its camera cannot be used. A light
    without a shadow channel has its own `light_status`, and no shadow.
    """
    messages = light_messages(lights)
    options: Dict[str, Any] = {
        "camera_convention": camera_convention,
        "depth_channel": depth_channel,
        "view": view,
        "shadow_channel": shadow_channel,
        "shadow_channels": dict(shadow_channels or {}),
        "shadow_bits_channel": shadow_bits_channel,
        "facing_channel": facing_channel,
        "mapped_channel": mapped_channel,
        "depth_kind": 0 if depth_kind is None else depth_kind_number(depth_kind),
    }
    for name, value in (
        ("near", near),
        ("far", far),
        ("pixel_aspect", pixel_aspect),
        ("background", background),
    ):
        if value is not None:
            options[name] = float(value)
    if camera is not None:
        message = camera.message if isinstance(camera, Camera) else camera
        options["camera"] = message.SerializeToString()
    name = os.fspath(path)
    light_list = light_pb2.LightList(lights=messages).SerializeToString()
    depth, shadow, facing, mapped, found, statuses, origin, begin, notes = _load.native().read_exr(
        name, light_list, options
    )
    for note in notes:
        warnings.warn(f"{name}: {_in_words_of_here(note)}", LightfitWarning, stacklevel=2)
    fine = None
    if cover is not None:
        fine_depth, fine_shadow, lit = _load.native().read_cover_exr(
            os.fspath(cover), light_list, options, found
        )
        fine = FineCover(fine_depth, fine_shadow, lit=_planes(lit, len(messages)))
    return ExrReadback(
        depth=depth,
        shadow=shadow,
        camera=Camera(camera_pb2.Camera.FromString(found)),
        lights=messages,
        light_status=[result_pb2.Status(code=code, message=text) for code, text in statuses],
        path=name,
        origin=result_pb2.ReadbackOrigin.FromString(origin),
        facing=_planes(facing, len(messages)),
        mapped=_planes(mapped, len(messages)),
        cover=fine,
        background=begin,
    )


def _in_words_of_here(note: str) -> str:
    """Options of the command line as arguments."""
    for option in ("background", "camera-convention"):
        note = note.replace(f"--{option} ", f"{option.replace('-', '_')} = ")
    return note.replace("--", "")


def _planes(
    words_and_lights: Tuple[NDArray[numpy.uint32], int], num_lights: int
) -> Optional[Planes]:
    """Of words whose bit l means something where bit l of the lights is 1."""
    words, lights = words_and_lights
    if lights == 0:
        return None
    return tuple(
        ((words >> numpy.uint32(light)) & 1) == 1 if (lights >> light) & 1 else None
        for light in range(num_lights)
    )
