"""The pixels of a read-back: checked numpy arrays, as messages and chunks of a stream, or as what
the compiled part takes. Pixels are copied only where their layout or type asks for it."""

from __future__ import annotations

import dataclasses
from typing import Any, Iterator, Optional, Tuple

import numpy
from numpy.typing import NDArray

from lightfit.errors import InvalidArgumentError
from lightfit.v1 import readback_pb2

CHUNK_BYTES = 1 << 20

_DEPTH_FORMATS = {
    numpy.dtype("float32"): readback_pb2.DEPTH_FORMAT_FLOAT32,
    numpy.dtype("float16"): readback_pb2.DEPTH_FORMAT_FLOAT16,
}


@dataclasses.dataclass(frozen=True)
class Pixels:
    """Exactly one of bits and planes is there; all arrays are contiguous and little-endian."""

    depth: NDArray[Any]  # (h, w) float32 or float16
    bits: Optional[NDArray[numpy.uint32]]  # (h, w)
    planes: Optional[NDArray[numpy.uint8]]  # (lights, h, w); 128 and above is blocked

    @property
    def height(self) -> int:
        return int(self.depth.shape[0])

    @property
    def width(self) -> int:
        return int(self.depth.shape[1])

    @property
    def num_bytes(self) -> int:
        shadow = self.bits if self.bits is not None else self.planes
        assert shadow is not None
        return int(self.depth.nbytes + shadow.nbytes)

    def header(self) -> readback_pb2.Readback:
        """The formats, without pixels."""
        readback = readback_pb2.Readback()
        readback.depth_format = _DEPTH_FORMATS[self.depth.dtype.newbyteorder("=")]
        readback.shadow_format = (
            readback_pb2.SHADOW_FORMAT_PLANES
            if self.bits is None
            else readback_pb2.SHADOW_FORMAT_BITS
        )
        return readback

    def fill(self, readback: readback_pb2.Readback) -> None:
        """Copies all pixels into a message."""
        readback.depth = self.depth.tobytes()
        if self.bits is not None:
            readback.shadow_bits = self.bits.tobytes()
        if self.planes is not None:
            readback.shadow_planes.extend(plane.tobytes() for plane in self.planes)

    def chunks(self) -> Iterator[readback_pb2.PixelChunk]:
        """All pixels in messages of at most 1 MiB of them."""
        for piece in _pieces(self.depth):
            yield readback_pb2.PixelChunk(depth=piece)
        if self.bits is not None:
            for piece in _pieces(self.bits):
                yield readback_pb2.PixelChunk(shadow_bits=piece)
        if self.planes is not None:
            for index, plane in enumerate(self.planes):
                for piece in _pieces(plane):
                    yield readback_pb2.PixelChunk(shadow_plane=piece, shadow_plane_index=index)

    def as_floats_and_bits(self) -> Tuple[NDArray[numpy.float32], NDArray[numpy.uint32]]:
        """What the library takes: (h, w) float32 and (h, w) uint32. Exact for halves, too."""
        bits = self.bits
        if self.planes is not None:
            bits = numpy.zeros(self.depth.shape, numpy.uint32)
            for index, plane in enumerate(self.planes):
                bits |= (plane >= 128).astype(numpy.uint32) << numpy.uint32(index)
        assert bits is not None
        return self.depth.astype(numpy.float32, copy=False), bits.astype(numpy.uint32, copy=False)


def check_pixels(depth: Any, shadow: Any, num_lights: int) -> Pixels:
    """depth: (h, w) float32 or float16. shadow: (h, w) uint32 bits, or (num_lights, h, w) planes of
    bool or uint8. Raises InvalidArgumentError with what was given and what is wanted."""
    depth = _array(depth, "depth")
    if depth.dtype.newbyteorder("=") not in _DEPTH_FORMATS:
        hint = ""
        if depth.dtype.kind in "fiu":
            hint = ": depth.astype(numpy.float32)"
        raise InvalidArgumentError(f"depth: has dtype {depth.dtype}, want float32 or float16{hint}")
    if depth.ndim != 2 or depth.size == 0:
        hint = ", one channel of it" if depth.ndim == 3 else ""
        raise InvalidArgumentError(
            f"depth: has shape {depth.shape}, want (height, width), top row first{hint}"
        )
    depth = _contiguous(depth)
    shadow = _array(shadow, "shadow")
    if shadow.ndim == 2:
        return Pixels(depth, _check_bits(shadow, depth.shape), None)
    return Pixels(depth, None, _check_planes(shadow, depth.shape, num_lights))


def _check_bits(shadow: NDArray[Any], size: Tuple[int, ...]) -> NDArray[numpy.uint32]:
    if shadow.dtype.newbyteorder("=") != numpy.uint32:
        hint = ": shadow.astype(numpy.uint32)" if shadow.dtype.kind == "i" else ""
        if shadow.dtype.kind == "b" or shadow.dtype == numpy.uint8:
            hint = "; planes, one per light, have shape (lights, height, width): shadow[None]"
        raise InvalidArgumentError(
            f"shadow: has shape {shadow.shape} and dtype {shadow.dtype}, want uint32 bits{hint}"
        )
    if shadow.shape != size:
        raise InvalidArgumentError(
            f"shadow: has shape {shadow.shape}, want that of depth, {size}"
        )
    return _contiguous(shadow)


def _check_planes(
    shadow: NDArray[Any], size: Tuple[int, ...], num_lights: int
) -> NDArray[numpy.uint8]:
    want = (num_lights, *size)
    if shadow.shape != want:
        hint = ""
        if shadow.shape == (*size, num_lights):
            hint = "; planes come first: numpy.moveaxis(shadow, -1, 0)"
        raise InvalidArgumentError(
            f"shadow: has shape {shadow.shape}, want {want}, one plane per light, or {size} of "
            f"uint32 bits{hint}"
        )
    if shadow.dtype == numpy.bool_:
        return _contiguous(shadow).view(numpy.uint8) * numpy.uint8(255)
    if shadow.dtype != numpy.uint8:
        hint = ": shadow > 0.5" if shadow.dtype.kind == "f" else ""
        raise InvalidArgumentError(
            f"shadow: has dtype {shadow.dtype}, want planes of bool, or of uint8 with 255 where "
            f"light is blocked{hint}"
        )
    return _contiguous(shadow)


def _array(values: Any, field: str) -> NDArray[Any]:
    if not isinstance(values, numpy.ndarray):
        raise InvalidArgumentError(
            f"{field}: is a {type(values).__name__}, want a numpy array (numpy.asarray)"
        )
    return values


def _contiguous(array: NDArray[Any]) -> NDArray[Any]:
    return numpy.ascontiguousarray(array, dtype=array.dtype.newbyteorder("<"))


def _pieces(array: NDArray[Any]) -> Iterator[bytes]:
    view = array.reshape(-1).view(numpy.uint8).data
    for begin in range(0, len(view), CHUNK_BYTES):
        yield bytes(view[begin : begin + CHUNK_BYTES])
