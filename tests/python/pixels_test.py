"""Arrays of a read-back: what is taken, how it travels, and what is refused in which words."""

from typing import Any

import numpy
import pytest

from lightfit.pixels import CHUNK_BYTES, check_pixels
from lightfit.v1 import readback_pb2

DEPTH = numpy.ones((3, 4), numpy.float32)
BITS = numpy.zeros((3, 4), numpy.uint32)


def random_planes(num_lights: int, height: int, width: int) -> Any:
    print("seed 5")
    return numpy.random.default_rng(5).integers(0, 256, (num_lights, height, width), numpy.uint8)


@pytest.mark.parametrize(
    "depth, words",
    [
        (DEPTH.astype(float), r"depth: has dtype float64.*depth.astype\(numpy.float32\)"),
        (DEPTH.astype(str), "depth: has dtype <U32, want float32 or float16$"),
        (DEPTH.tolist(), "depth: is a list, want a numpy array"),
        (DEPTH[0], r"depth: has shape \(4,\), want \(height, width\)"),
        (DEPTH[:, :, None], r"depth: has shape \(3, 4, 1\).*one channel"),
        (DEPTH[:0], r"depth: has shape \(0, 4\)"),
    ],
)
def test_depths_that_are_none_are_refused(depth: Any, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        check_pixels(depth, BITS, 1)


@pytest.mark.parametrize(
    "shadow, words",
    [
        (BITS.T, r"shadow: has shape \(4, 3\), want that of depth, \(3, 4\)"),
        (BITS.astype(numpy.int64), r"dtype int64, want uint32 bits: shadow.astype"),
        (BITS.astype(bool), r"want uint32 bits; planes, one per light, .*shadow\[None\]"),
        (numpy.zeros((3, 4, 2), bool), r"planes come first: numpy.moveaxis\(shadow, -1, 0\)"),
        (numpy.zeros((3, 3, 4), bool), r"has shape \(3, 3, 4\), want \(2, 3, 4\), one plane"),
        (numpy.zeros((2, 3, 4)), r"has dtype float64, want planes of bool.*shadow > 0.5"),
        (numpy.zeros(12, bool), r"has shape \(12,\)"),
        (None, "shadow: is a NoneType"),
    ],
)
def test_shadows_that_are_none_are_refused(shadow: Any, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        check_pixels(DEPTH, shadow, 2)


@pytest.mark.parametrize(
    "facing, words",
    [
        (BITS.T, r"facing: has shape \(4, 3\), want that of depth, \(3, 4\)"),
        (numpy.zeros((2, 3, 4)), r"facing: has dtype float64.*faces the light: facing > 0.5"),
        ([None], "facing: has 1 planes, want 2, one per light, None where it is not known"),
        ([None, BITS.T > 0], r"facing\[1\]: has shape \(4, 3\), want that of depth"),
        ([DEPTH, None], r"facing\[0\]: has dtype float32.*faces the light: facing\[0\] > 0.5"),
        ([None, "lamp"], r"facing\[1\]: is a str, want a numpy array"),
        ("bits", "facing: is a str"),
    ],
)
def test_facing_that_is_none_is_refused(facing: Any, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        check_pixels(DEPTH, BITS, 2, facing=facing)
    with pytest.raises(ValueError, match=words.replace("facing", "mapped", 1).split(".*")[0]):
        check_pixels(DEPTH, BITS, 2, mapped=facing)


def test_facing_that_is_known_of_no_light_is_absent() -> None:
    pixels = check_pixels(DEPTH, BITS, 2, facing=[None, None])
    assert pixels.facing is None and pixels.optional_bits() == (None, None)


def test_pixels_that_fit_are_not_copied() -> None:
    pixels = check_pixels(DEPTH, BITS, 1)
    depth, bits = pixels.as_floats_and_bits()
    assert numpy.shares_memory(depth, DEPTH) and numpy.shares_memory(bits, BITS)


def test_views_and_foreign_bytes_become_contiguous() -> None:
    depth = numpy.arange(48, dtype=">f4").reshape(6, 8)[::2, ::2]
    pixels = check_pixels(depth, BITS, 1)
    floats, _ = pixels.as_floats_and_bits()
    assert numpy.array_equal(floats, depth) and floats.flags.c_contiguous
    readback = pixels.header()
    pixels.fill(readback)
    assert readback.depth == depth.astype("<f4").tobytes()


def test_planes_and_bits_say_the_same() -> None:
    planes = random_planes(32, 5, 7)
    depth = numpy.ones((5, 7), numpy.float16)
    _, bits = check_pixels(depth, planes, 32).as_floats_and_bits()
    for y, x in numpy.ndindex(5, 7):
        want = sum(1 << light for light in range(32) if planes[light, y, x] >= 128)
        assert bits[y, x] == want
    _, of_bool = check_pixels(depth, planes >= 128, 32).as_floats_and_bits()
    assert numpy.array_equal(of_bool, bits)


def test_halves_become_floats_exactly() -> None:
    halves = numpy.arange(65536, dtype=numpy.uint16).view(numpy.float16).reshape(256, 256)
    bits = numpy.zeros((256, 256), numpy.uint32)
    floats, _ = check_pixels(halves, bits, 1).as_floats_and_bits()
    with numpy.errstate(invalid="ignore"):  # signalling NaNs become quiet ones
        assert numpy.array_equal(floats.astype(float), halves.astype(float), equal_nan=True)


@pytest.mark.parametrize("dtype", [numpy.float32, numpy.float16])
@pytest.mark.parametrize("has_planes", [False, True])
def test_chunks_are_the_message_in_pieces(dtype: Any, has_planes: bool) -> None:
    height, width = 1030, 517  # not a whole number of chunks
    generator = numpy.random.default_rng(7)
    depth = generator.random((height, width)).astype(dtype)
    shadow = (
        random_planes(3, height, width)
        if has_planes
        else generator.integers(0, 2**32, (height, width), numpy.uint32)
    )
    facing = random_planes(3, height, width)
    mapped = [None, facing[1] >= 99, None]
    pixels = check_pixels(depth, shadow, 3, facing if has_planes else shadow + 1, mapped)
    whole = pixels.header()
    pixels.fill(whole)
    assert (whole.facing_lights, whole.mapped_lights) == (0, 2)
    joined = pixels.header()
    planes = {kind: [b""] * 3 for kind in ("shadow", "facing", "mapped")}
    num_bytes = 0
    for chunk in pixels.chunks():
        size = len(chunk.depth)
        joined.depth += chunk.depth
        for kind in planes:
            bits, plane = getattr(chunk, f"{kind}_bits"), getattr(chunk, f"{kind}_plane")
            setattr(joined, f"{kind}_bits", getattr(joined, f"{kind}_bits") + bits)
            planes[kind][getattr(chunk, f"{kind}_plane_index")] += plane
            size += len(bits) + len(plane)
        assert 0 < size <= CHUNK_BYTES
        num_bytes += size
    for kind in planes:
        if any(planes[kind]):
            getattr(joined, f"{kind}_planes").extend(planes[kind])
    assert joined == whole
    assert pixels.num_bytes == num_bytes
