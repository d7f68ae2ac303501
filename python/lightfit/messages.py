"""How parts of messages are read: shared by what the calls give."""

from __future__ import annotations

import dataclasses
from typing import Any, Optional

import numpy
from numpy.typing import NDArray

from lightfit.v1 import matrix_pb2, result_pb2

Matrix = NDArray[numpy.float64]


@dataclasses.dataclass(frozen=True)
class Footprint:
    """How far one texel reaches on the screen, read-back pixels per texel. 1 is one-to-one."""

    rms: float
    median: Optional[float]  # None, as p99 and worst, with options compute_statistics: False
    p99: Optional[float]
    worst: Optional[float]


def matrix_of(message: matrix_pb2.Matrix4x4) -> Optional[Matrix]:
    return numpy.array(message.m, dtype=numpy.float64).reshape(4, 4) if message.m else None


def optional(message: Any, field: str, read: Any = lambda value: value) -> Any:
    return read(getattr(message, field)) if message.HasField(field) else None


def footprint_of(message: result_pb2.FootprintStatistics) -> Footprint:
    return Footprint(
        message.rms, *(optional(message, name) for name in ("median", "p99", "worst"))
    )


def word_of(enum: Any, number: int, prefix: str) -> str:
    word = enum.DESCRIPTOR.values_by_number.get(number)
    return str(word.name)[len(prefix) :] if word else str(number)


def lower_word(enum: Any, number: int, prefix: str) -> Optional[str]:
    """None for what is unspecified."""
    return word_of(enum, number, prefix).lower() if number != 0 else None
