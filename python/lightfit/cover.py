"""A read-back's view in finer cells, for the room that a map has: what is thinner than a pixel of the
read-back lies outside of a map that is fitted tightly."""

from __future__ import annotations

import dataclasses
from typing import Any, Iterator, Optional, Tuple

import numpy
from numpy.typing import NDArray

from lightfit.errors import InvalidArgumentError
from lightfit.pixels import check_depth, check_optional_bits, check_pixels, pieces
from lightfit.v1 import readback_pb2


@dataclasses.dataclass(frozen=True, eq=False)
class FineCover:
    """A larger image of the same frame, more pixels both ways, or cells of several of its pixels.

    depth: (rows, columns) float32 or float16, of the read-back's depth kind; of cells the nearest.
    shadow: as for `fit`, of this size; of cells where any pixel is blocked.
    facing: as for `fit`: tells what is lit, for a dark border. Of an image alone.
    furthest: of cells, the furthest surface, as depth.
    lit: of cells instead of facing, as shadow or a list of planes with None: where any pixel that
        faces the light is lit. Then `shadow` has only what faces it, too.
    """

    depth: Any
    shadow: Any
    facing: Any = None
    furthest: Any = None
    lit: Any = None


@dataclasses.dataclass(frozen=True, eq=False)
class CheckedCover:
    """The same as messages have it; all arrays contiguous and little-endian."""

    nearest: NDArray[numpy.float32]
    furthest: Optional[NDArray[numpy.float32]]
    shadow_bits: NDArray[numpy.uint32]
    lit_bits: Optional[NDArray[numpy.uint32]]
    lit_lights: int

    @property
    def num_bytes(self) -> int:
        return sum(int(array.nbytes) for _, array in self._arrays())

    def put_header(self, readback: readback_pb2.Readback) -> None:
        cover = readback.fine_cover
        cover.rows, cover.columns = self.nearest.shape
        cover.lit_lights = self.lit_lights
        cover.with_furthest = self.furthest is not None

    def fill(self, readback: readback_pb2.Readback) -> None:
        for name, array in self._arrays():
            setattr(readback.fine_cover, name, array.tobytes())

    def chunks(self) -> Iterator[readback_pb2.PixelChunk]:
        for name, array in self._arrays():
            for piece in pieces(array):
                yield readback_pb2.PixelChunk(**{f"fine_{name}": piece})  # type: ignore[arg-type]

    def _arrays(self) -> Iterator[Tuple[str, NDArray[Any]]]:
        yield "nearest", self.nearest
        if self.furthest is not None:
            yield "furthest", self.furthest
        yield "shadow_bits", self.shadow_bits
        if self.lit_bits is not None:
            yield "lit_bits", self.lit_bits


def check_cover(cover: Optional[FineCover], num_lights: int) -> Optional[CheckedCover]:
    if cover is None:
        return None
    if not isinstance(cover, FineCover):
        raise InvalidArgumentError(
            f"cover: is a {type(cover).__name__}, want lightfit.FineCover(depth, shadow)"
        )
    try:
        return _checked(cover, num_lights)
    except InvalidArgumentError as error:
        raise InvalidArgumentError(f"cover: {error.message}") from None


def _checked(cover: FineCover, num_lights: int) -> CheckedCover:
    if cover.facing is not None and cover.lit is not None:
        raise InvalidArgumentError("want facing, of an image, or lit, of cells, not both")
    pixels = check_pixels(cover.depth, cover.shadow, num_lights, cover.facing)
    nearest, shadow = pixels.as_floats_and_bits()
    furthest = None
    if cover.furthest is not None:
        furthest = check_depth("furthest", cover.furthest).astype(numpy.float32, copy=False)
        if furthest.shape != nearest.shape:
            raise InvalidArgumentError(
                f"furthest: has shape {furthest.shape}, want that of depth, {nearest.shape}"
            )
    lit, lit_lights = None, 0
    if pixels.facing is not None:
        lit_lights = pixels.facing.known_lights(num_lights)
        facing = pixels.facing.as_words(shadow.shape) & numpy.uint32(lit_lights)
        lit = facing & ~shadow
        shadow = shadow & (facing | ~numpy.uint32(lit_lights))
    given = check_optional_bits("lit", cover.lit, shadow.shape, num_lights)
    if given is not None:
        lit_lights = given.known_lights(num_lights)
        lit = given.as_words(shadow.shape)
    return CheckedCover(nearest, furthest, shadow, lit, lit_lights)
