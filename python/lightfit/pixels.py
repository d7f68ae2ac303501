"""The pixels of a read-back: checked numpy arrays, as messages and chunks of a stream, or as what
the compiled part takes. Pixels are copied only where their layout or type asks for it."""

from __future__ import annotations

import dataclasses
from typing import Any, Dict, Iterator, Optional, Protocol, Sequence, Tuple

import numpy
from numpy.typing import NDArray

from lightfit.errors import InvalidArgumentError
from lightfit.v1 import readback_pb2

CHUNK_BYTES = 1 << 20

_DEPTH_FORMATS = {
    numpy.dtype("float32"): readback_pb2.DEPTH_FORMAT_FLOAT32,
    numpy.dtype("float16"): readback_pb2.DEPTH_FORMAT_FLOAT16,
}


_MEANINGS = {
    "shadow": "light is blocked",
    "facing": "the surface faces the light",
    "mapped": "the map says shadow",
    "lit": "light arrives",
}

class Part(Protocol):
    """What comes with the depth."""

    @property
    def num_bytes(self) -> int: ...

    def put_header(self, readback: readback_pb2.Readback) -> None:
        """What is known before the pixels."""

    def fill(self, readback: readback_pb2.Readback) -> None:
        """Copies the pixels into a message."""

    def chunks(self) -> Iterator[readback_pb2.PixelChunk]: ...


Plane = NDArray[numpy.uint8]  # (h, w); 128 and above counts


@dataclasses.dataclass(frozen=True)
class Bits:
    """One bit per pixel and light. Exactly one of bits and planes is there; all arrays are
    contiguous and little-endian."""

    name: str  # of the fields NAME_bits, NAME_planes ... of a Readback
    bits: Optional[NDArray[numpy.uint32]]  # (h, w), of all lights
    planes: Optional[Sequence[Optional[Plane]]]  # of each light; None where it is not known

    @property
    def num_bytes(self) -> int:
        if self.bits is not None:
            return int(self.bits.nbytes)
        return sum(int(plane.nbytes) for _, plane in self._known())

    def put_header(self, readback: readback_pb2.Readback) -> None:
        """The format, and of which lights it is known unless that is all of them."""
        word = "SHADOW_FORMAT_BITS" if self.planes is None else "SHADOW_FORMAT_PLANES"
        setattr(readback, f"{self.name}_format", readback_pb2.ShadowFormat.Value(word))
        if self.planes is not None and any(plane is None for plane in self.planes):
            known = sum(1 << index for index, _ in self._known())
            setattr(readback, f"{self.name}_lights", known)

    def fill(self, readback: readback_pb2.Readback) -> None:
        if self.bits is not None:
            setattr(readback, f"{self.name}_bits", self.bits.tobytes())
        for plane in self.planes or ():
            planes = getattr(readback, f"{self.name}_planes")
            planes.append(b"" if plane is None else plane.tobytes())

    def chunks(self) -> Iterator[readback_pb2.PixelChunk]:
        fields: Dict[str, Any]
        if self.bits is not None:
            for piece in pieces(self.bits):
                fields = {f"{self.name}_bits": piece}
                yield readback_pb2.PixelChunk(**fields)
        for index, plane in self._known():
            for piece in pieces(plane):
                fields = {f"{self.name}_plane": piece, f"{self.name}_plane_index": index}
                yield readback_pb2.PixelChunk(**fields)

    def as_words(self, size: Tuple[int, ...]) -> NDArray[numpy.uint32]:
        """(h, w), light l in bit l."""
        if self.bits is not None:
            return self.bits.astype(numpy.uint32, copy=False)
        words = numpy.zeros(size, numpy.uint32)
        for index, plane in self._known():
            words |= (plane >= 128).astype(numpy.uint32) << numpy.uint32(index)
        return words

    def known_lights(self, num_lights: int) -> int:
        """Bit l is that of light l."""
        if self.planes is None:
            return (1 << num_lights) - 1
        return sum(1 << index for index, _ in self._known())

    def _known(self) -> Iterator[Tuple[int, Plane]]:
        for index, plane in enumerate(self.planes or ()):
            if plane is not None:
                yield index, plane


@dataclasses.dataclass(frozen=True)
class Pixels:
    depth: NDArray[Any]  # (h, w) float32 or float16, contiguous and little-endian
    shadow: Bits
    facing: Optional[Bits] = None
    mapped: Optional[Bits] = None
    cover: Optional[Part] = None

    @property
    def height(self) -> int:
        return int(self.depth.shape[0])

    @property
    def width(self) -> int:
        return int(self.depth.shape[1])

    @property
    def num_bytes(self) -> int:
        return int(self.depth.nbytes) + sum(part.num_bytes for part in self._parts())

    def header(self) -> readback_pb2.Readback:
        """The formats, without pixels."""
        readback = readback_pb2.Readback()
        readback.depth_format = _DEPTH_FORMATS[self.depth.dtype.newbyteorder("=")]
        for part in self._parts():
            part.put_header(readback)
        return readback

    def fill(self, readback: readback_pb2.Readback) -> None:
        """Copies all pixels into a message."""
        readback.depth = self.depth.tobytes()
        for part in self._parts():
            part.fill(readback)

    def chunks(self) -> Iterator[readback_pb2.PixelChunk]:
        """All pixels in messages of at most 1 MiB of them."""
        for piece in pieces(self.depth):
            yield readback_pb2.PixelChunk(depth=piece)
        for part in self._parts():
            yield from part.chunks()

    def as_floats_and_bits(self) -> Tuple[NDArray[numpy.float32], NDArray[numpy.uint32]]:
        """What the library takes: (h, w) float32 and (h, w) uint32. Exact for halves, too."""
        return self.depth.astype(numpy.float32, copy=False), self.shadow.as_words(self.depth.shape)

    def optional_bits(
        self,
    ) -> Tuple[Optional[NDArray[numpy.uint32]], Optional[NDArray[numpy.uint32]]]:
        """Facing and mapped, likewise."""
        size = self.depth.shape
        return (
            None if self.facing is None else self.facing.as_words(size),
            None if self.mapped is None else self.mapped.as_words(size),
        )

    def _parts(self) -> Iterator[Part]:
        yield self.shadow
        if self.facing is not None:
            yield self.facing
        if self.mapped is not None:
            yield self.mapped
        if self.cover is not None:
            yield self.cover


def check_pixels(
    depth: Any, shadow: Any, num_lights: int, facing: Any = None, mapped: Any = None
) -> Pixels:
    """depth: (h, w) float32 or float16. shadow: (h, w) uint32 bits, or (num_lights, h, w) planes of
    bool or uint8. facing, mapped: the same, or one (h, w) plane per light with None where it is not
    known; None: of no light. Raises InvalidArgumentError with what was given and what is wanted."""
    depth = check_depth("depth", depth)
    return Pixels(
        depth,
        _check_bits("shadow", shadow, depth.shape, num_lights),
        check_optional_bits("facing", facing, depth.shape, num_lights),
        check_optional_bits("mapped", mapped, depth.shape, num_lights),
    )


def check_depth(field: str, depth: Any) -> NDArray[Any]:
    """(h, w) float32 or float16, contiguous and little-endian."""
    depth = _array(depth, field)
    if depth.dtype.newbyteorder("=") not in _DEPTH_FORMATS:
        hint = ""
        if depth.dtype.kind in "fiu":
            hint = f": {field}.astype(numpy.float32)"
        raise InvalidArgumentError(
            f"{field}: has dtype {depth.dtype}, want float32 or float16{hint}"
        )
    if depth.ndim != 2 or depth.size == 0:
        hint = ", one channel of it" if depth.ndim == 3 else ""
        raise InvalidArgumentError(
            f"{field}: has shape {depth.shape}, want (height, width), top row first{hint}"
        )
    return _contiguous(depth)


def _check_bits(field: str, values: Any, size: Tuple[int, ...], num_lights: int) -> Bits:
    values = _array(values, field)
    if values.ndim == 2:
        return Bits(field, _check_words(field, values, size), None)
    return Bits(field, None, list(_check_planes(field, values, size, num_lights)))


def check_optional_bits(
    field: str, values: Any, size: Tuple[int, ...], num_lights: int
) -> Optional[Bits]:
    if not isinstance(values, (list, tuple)):
        return None if values is None else _check_bits(field, values, size, num_lights)
    if len(values) != num_lights:
        raise InvalidArgumentError(
            f"{field}: has {len(values)} planes, want {num_lights}, one per light, None where it "
            "is not known"
        )
    planes = [
        None if plane is None else _check_plane(f"{field}[{index}]", plane, size)
        for index, plane in enumerate(values)
    ]
    return None if all(plane is None for plane in planes) else Bits(field, None, planes)


def _check_words(
    field: str, words: NDArray[Any], size: Tuple[int, ...]
) -> NDArray[numpy.uint32]:
    if words.dtype.newbyteorder("=") != numpy.uint32:
        hint = f": {field}.astype(numpy.uint32)" if words.dtype.kind == "i" else ""
        if words.dtype.kind == "b" or words.dtype == numpy.uint8:
            hint = f"; planes, one per light, have shape (lights, height, width): {field}[None]"
        raise InvalidArgumentError(
            f"{field}: has shape {words.shape} and dtype {words.dtype}, want uint32 bits{hint}"
        )
    if words.shape != size:
        raise InvalidArgumentError(f"{field}: has shape {words.shape}, want that of depth, {size}")
    return _contiguous(words)


def _check_planes(
    field: str, planes: NDArray[Any], size: Tuple[int, ...], num_lights: int
) -> NDArray[numpy.uint8]:
    want = (num_lights, *size)
    if planes.shape != want:
        hint = ""
        if planes.shape == (*size, num_lights):
            hint = f"; planes come first: numpy.moveaxis({field}, -1, 0)"
        raise InvalidArgumentError(
            f"{field}: has shape {planes.shape}, want {want}, one plane per light, or {size} of "
            f"uint32 bits{hint}"
        )
    return _check_plane_values(field, planes)


def _check_plane(field: str, plane: Any, size: Tuple[int, ...]) -> Plane:
    plane = _array(plane, field)
    if plane.shape != size:
        raise InvalidArgumentError(f"{field}: has shape {plane.shape}, want that of depth, {size}")
    return _check_plane_values(field, plane)


def _check_plane_values(field: str, planes: NDArray[Any]) -> NDArray[numpy.uint8]:
    if planes.dtype == numpy.bool_:
        return _contiguous(planes).view(numpy.uint8) * numpy.uint8(255)
    if planes.dtype != numpy.uint8:
        hint = f": {field} > 0.5" if planes.dtype.kind == "f" else ""
        raise InvalidArgumentError(
            f"{field}: has dtype {planes.dtype}, want planes of bool, or of uint8 with 255 where "
            f"{_MEANINGS[field.split('[')[0]]}{hint}"
        )
    return _contiguous(planes)


def _array(values: Any, field: str) -> NDArray[Any]:
    if not isinstance(values, numpy.ndarray):
        raise InvalidArgumentError(
            f"{field}: is a {type(values).__name__}, want a numpy array (numpy.asarray)"
        )
    if isinstance(values, numpy.ma.MaskedArray):
        if numpy.any(values.mask):
            hint = f"{field}.filled(0)"
            if values.dtype.kind == "f":
                hint = f"{field}.filled(numpy.inf), or the depth of the far plane"
            raise InvalidArgumentError(
                f"{field}: is a masked array, and what its mask hides is no background by itself: "
                f"want {hint}"
            )
        return numpy.asarray(values.data)
    return values


def _contiguous(array: NDArray[Any]) -> NDArray[Any]:
    return numpy.ascontiguousarray(array, dtype=array.dtype.newbyteorder("<"))


def pieces(array: NDArray[Any]) -> Iterator[bytes]:
    view = array.reshape(-1).view(numpy.uint8).data
    for begin in range(0, len(view), CHUNK_BYTES):
        yield bytes(view[begin : begin + CHUNK_BYTES])
