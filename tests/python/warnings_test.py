"""Read-backs that are used as they are and may be a mistake; skies at a finite depth."""

import math
import warnings
from typing import Any, Dict, List

import numpy
import pytest

import lightfit
from conftest import ROOM, YARD
from lightfit.pixels import check_pixels
from lightfit.v1 import camera_pb2

MAP = (256, 256)


def texts(call: Any, *args: Any, **fields: Any) -> List[str]:
    """What the call warns of."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        call(*args, **fields)
    assert all(issubclass(warning.category, lightfit.LightfitWarning) for warning in caught)
    return [str(warning.message) for warning in caught]


def args_of(readback: lightfit.ExrReadback) -> Dict[str, Any]:
    return {
        "depth": readback.depth,
        "shadow": readback.shadow,
        "camera": readback.camera,
        "lights": readback.lights,
        "map_size": MAP,
    }


def test_a_read_back_that_is_right_is_not_spoken_of(yard: lightfit.ExrReadback) -> None:
    assert texts(lightfit.fit, **args_of(yard)) == []


@pytest.mark.parametrize("shadow_of_sky", [0, 1])
def test_a_finite_sky_is_background(yard: lightfit.ExrReadback, shadow_of_sky: int) -> None:
    clean = lightfit.fit(**args_of(yard), options={"cover": "receivers"})
    sky = yard.depth >= 1e9
    fields = args_of(yard)
    fields["depth"] = numpy.where(sky, numpy.float32(1e6), yard.depth)
    fields["shadow"] = numpy.where(sky, numpy.uint32(7 * shadow_of_sky), yard.shadow)
    with pytest.warns(lightfit.LightfitWarning, match="background = 1000000") as caught:
        found = lightfit.fit(**fields, options={"cover": "receivers"})
    assert caught[0].filename == __file__
    assert found.message.readback.background == 1e6
    stated = lightfit.fit(**fields, options={"cover": "receivers"}, background=1e5)
    for light in ("sun", "key", "rim"):
        assert numpy.array_equal(found[light].map_from_world, clean[light].map_from_world)
        assert numpy.array_equal(stated[light].map_from_world, clean[light].map_from_world)
    assert texts(lightfit.fit, **fields, background=1e5) == []


@pytest.mark.parametrize("background", [0, -1, math.nan, "sky"])
def test_backgrounds_that_are_no_depth_are_refused(
    yard: lightfit.ExrReadback, background: Any
) -> None:
    with pytest.raises(lightfit.InvalidArgumentError, match="background = "):
        lightfit.fit(**args_of(yard), background=background)


def test_an_inverted_pass_is_told_of(yard: lightfit.ExrReadback) -> None:
    fields = args_of(yard)
    fields["shadow"] = ~yard.shadow
    found = texts(lightfit.fit, **fields)
    assert len(found) == 3 and all("the wrong way round" in text for text in found)


def test_lights_of_another_scene_are_told_of() -> None:
    found = texts(lightfit.fit_exr, ROOM / "0001.exr", YARD / "scene.json", MAP)
    assert any("another scene" in text for text in found)


def test_inverse_depths_are_told_of(yard: lightfit.ExrReadback) -> None:
    fields = args_of(yard)
    fields["depth"] = numpy.where(yard.depth < 1e9, 1 / yard.depth, 0).astype(numpy.float32)
    assert any("0 ... 1" in text for text in texts(lightfit.fit, **fields))


def test_masked_arrays_are_refused_unless_nothing_is_masked() -> None:
    depth = numpy.ma.masked_greater(numpy.full((3, 4), 5, numpy.float32), 9)
    bits = numpy.zeros((3, 4), numpy.uint32)
    assert type(check_pixels(depth, bits, 1).depth) is numpy.ndarray
    depth[0, 0] = numpy.ma.masked
    with pytest.raises(ValueError, match=r"depth: is a masked array.*depth.filled\(numpy.inf\)"):
        check_pixels(depth, bits, 1)
    masked = numpy.ma.masked_equal(bits, 0)
    with pytest.raises(ValueError, match=r"shadow: is a masked array.*shadow.filled\(0\)"):
        check_pixels(numpy.ones((3, 4), numpy.float32), masked, 1)


def test_transposed_arrays_are_refused_with_the_way_out() -> None:
    message = camera_pb2.Camera(width=60, height=40)
    depth = numpy.ones((60, 40), numpy.float32)
    with pytest.raises(lightfit.InvalidArgumentError, match="depth.T"):
        lightfit.fit(
            depth, numpy.zeros((60, 40), numpy.uint32), message,
            [lightfit.Light.sun("sun", (0, 0, -1))], MAP,
        )
