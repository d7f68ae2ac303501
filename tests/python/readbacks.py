"""Read-backs that are computed, of any size."""

from __future__ import annotations

from typing import Any, Tuple

import numpy

import lightfit
from lightfit.v1 import camera_pb2


def large_readback(width: int, height: int) -> Tuple[Any, Any, Any, Any]:
    """The first arguments of `fit`: a floor one unit below the camera with round shadows on it, and
    a wall 20 units away, computed at pixel centres."""
    focal_px = 0.8 * width
    x = (numpy.arange(width) + 0.5 - width / 2)[None, :] / focal_px
    y = (numpy.arange(height) + 0.5 - height / 3)[:, None] / focal_px
    with numpy.errstate(divide="ignore"):
        depth = numpy.where(y > 1 / 20, 1 / y, 20.0) + 0 * x
    across = (x * depth) % 2 - 1
    along = depth % 2 - 1
    lights = [
        lightfit.Light.sun("sun", (0.2, 1, 0.3)),
        lightfit.Light.point("key", (3, -6, 8)),
        lightfit.Light.point("rim", (-2, -4, 12)),
    ]
    shadow = numpy.zeros((height, width), numpy.uint32)
    for light, radius in enumerate((0.4, 0.6, 0.8)):
        is_blocked = (across**2 + along**2 < radius**2) & (y > 1 / 20)
        shadow |= is_blocked.astype(numpy.uint32) << numpy.uint32(light)
    camera = camera_pb2.Camera(width=width, height=height)
    camera.camera_from_world.m.extend(numpy.eye(4).ravel())
    camera.intrinsics.fx = camera.intrinsics.fy = focal_px
    camera.intrinsics.cx, camera.intrinsics.cy = width / 2, height / 3
    return depth.astype(numpy.float32), shadow, camera, lights
