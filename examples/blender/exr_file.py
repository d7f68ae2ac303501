"""OpenEXR files without compression, in numpy alone: Blender's Python comes with no EXR module.

Only what this example meets: one part, scan lines, half and float channels, NO_COMPRESSION.
Layout: https://openexr.com/en/latest/OpenEXRFileLayout.html
"""

from __future__ import annotations

import struct
from typing import Dict, Optional, Tuple

import numpy

_MAGIC = 20000630
_LONG_NAMES = 0x400  # names may be longer than 31 bytes
_TYPES = {1: numpy.dtype("<f2"), 2: numpy.dtype("<f4")}  # as the file numbers them
_NUMBERS = {kind: number for number, kind in _TYPES.items()}


def read_exr(path: str) -> Dict[str, numpy.ndarray]:
    """Channel name to (height, width) array, top row first. Raises ValueError."""
    with open(path, "rb") as file:
        data = file.read()
    magic, _ = struct.unpack_from("<2i", data)
    if magic != _MAGIC:
        raise ValueError(f"{path}: is no OpenEXR file")
    attributes, begin = _attributes(data, 8)
    if attributes["compression"] != b"\0":
        raise ValueError(f"{path}: is compressed, want exr_codec = 'NONE'")
    left, top, right, bottom = struct.unpack("<4i", attributes["dataWindow"])
    width, height = right - left + 1, bottom - top + 1
    # Of each line: its number, its size in bytes, and one channel after the other.
    line = numpy.dtype(
        [("y", "<i4"), ("num_bytes", "<i4")]
        + [(name, kind, (width,)) for name, kind in _channels(attributes["channels"])]
    )
    offsets = struct.unpack_from(f"<{height}Q", data, begin)
    lines = numpy.array([numpy.frombuffer(data, line, 1, offset)[0] for offset in offsets], line)
    lines = lines[numpy.argsort(lines["y"])]
    return {name: lines[name].copy() for name in line.names[2:]}


def write_exr(
    path: str,
    channels: Dict[str, numpy.ndarray],
    matrices: Dict[str, numpy.ndarray],
    pixel_aspect: float = 1.0,
    strings: Optional[Dict[str, str]] = None,
) -> None:
    """channels: (height, width) float16 or float32 each. matrices: header attributes, (4, 4) for
    column vectors; stored for row vectors in single precision, as the OpenEXR standard has them.
    pixel_aspect: width over height of a pixel. strings: header attributes."""
    names = sorted(channels, key=str.encode)
    height, width = channels[names[0]].shape
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    listed = b"".join(
        name.encode() + struct.pack("<xi4x2i", _NUMBERS[channels[name].dtype], 1, 1)
        for name in names
    )
    attributes = {
        "channels": ("chlist", listed + b"\0"),
        "compression": ("compression", b"\0"),
        "dataWindow": ("box2i", window),
        "displayWindow": ("box2i", window),
        "lineOrder": ("lineOrder", b"\0"),
        "pixelAspectRatio": ("float", struct.pack("<f", pixel_aspect)),
        "screenWindowCenter": ("v2f", struct.pack("<2f", 0, 0)),
        "screenWindowWidth": ("float", struct.pack("<f", 1)),
    }
    for name, matrix in matrices.items():
        attributes[name] = ("m44f", numpy.ascontiguousarray(matrix.T, "<f4").tobytes())
    for name, text in (strings or {}).items():
        attributes[name] = ("string", text.encode())
    header = struct.pack("<2i", _MAGIC, 2 | _LONG_NAMES) + b"".join(
        name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value
        for name, (kind, value) in attributes.items()
    )
    header += b"\0"
    line_bytes = sum(channels[name].dtype.itemsize * width for name in names)
    first = len(header) + 8 * height
    offsets = [first + y * (8 + line_bytes) for y in range(height)]
    with open(path, "wb") as file:
        file.write(header)
        file.write(struct.pack(f"<{height}Q", *offsets))
        for y in range(height):
            file.write(struct.pack("<2i", y, line_bytes))
            file.write(b"".join(channels[name][y].tobytes() for name in names))


def _attributes(data: bytes, at: int) -> Tuple[Dict[str, bytes], int]:
    """Name to value, and where the header ends."""
    attributes: Dict[str, bytes] = {}
    while data[at]:
        name, at = _word(data, at)
        _, at = _word(data, at)  # its type
        (size,) = struct.unpack_from("<i", data, at)
        attributes[name] = data[at + 4 : at + 4 + size]
        at += 4 + size
    return attributes, at + 1


def _channels(data: bytes) -> list:
    """(name, dtype) in the order of the file."""
    channels, at = [], 0
    while data[at]:
        name, at = _word(data, at)
        (number,) = struct.unpack_from("<i", data, at)
        channels.append((name, _TYPES[number]))
        at += 16
    return channels


def _word(data: bytes, at: int) -> Tuple[str, int]:
    end = data.index(b"\0", at)
    return data[at:end].decode(), end + 1
