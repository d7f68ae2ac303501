"""A read-back as clients in other languages send it: request.json, depth.f32 and shadow.u32.

    PYTHONPATH=build/release/python python3 examples/write_request.py \\
        READBACK.exr LIGHTS.json WIDTHxHEIGHT FOLDER

request.json is a lightfit.v1.FitRequest without pixels; the other two are its fields depth (32-bit
floats) and shadow_bits (32-bit integers), row by row from the top, little-endian.
"""

import pathlib
import sys

import lightfit
from google.protobuf import json_format
from lightfit.request import fit_request


def main() -> None:
    if len(sys.argv) != 5:
        sys.exit("usage: write_request.py READBACK.exr LIGHTS.json WIDTHxHEIGHT FOLDER")
    exr, lights, size, folder = sys.argv[1:]
    readback = lightfit.read_exr(exr, lights)
    map_size = tuple(int(side) for side in size.split("x"))
    request = fit_request(readback.parts(), map_size, None, "vulkan", False)
    out = pathlib.Path(folder)
    out.mkdir(parents=True, exist_ok=True)
    (out / "request.json").write_text(json_format.MessageToJson(request, indent=1))
    (out / "depth.f32").write_bytes(readback.depth.astype("<f4").tobytes())
    (out / "shadow.u32").write_bytes(readback.shadow.astype("<u4").tobytes())


if __name__ == "__main__":
    main()
