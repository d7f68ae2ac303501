"""Checks that rooms include only what lies below them.

    scripts/check_layers.py

In: the C++ sources below the current folder, the repository's root. Out: a line for each #include
that goes the wrong way; exit status 1 when there is one.

A room is a folder, or a single file that is a layer of its own. A file belongs to the longest of the
names below that its path begins with.
"""

import fnmatch
import pathlib
import re
import sys
from typing import Dict, List

# Each room, lowest first, and the rooms that it may include besides itself: NAME is that room alone,
# NAME/* all rooms below NAME. `lightfit` are the messages generated from proto/lightfit.
READBACK = "base geometry optimizer/readback"
ENERGY = f"{READBACK} optimizer/energy"
SEARCH = f"{ENERGY} optimizer/search"
FIGURES = f"{SEARCH} optimizer/figures"
FIT = f"{FIGURES} optimizer"
SIZING = f"{FIT} optimizer/sizing"
CORE = f"{SIZING} optimizer/tracking"
PLANS = f"{CORE} partition partition/tracking"
WIRE = f"{PLANS} lightfit proto wire"
IO = f"{WIRE} scenes io"
JOBS = f"{IO} jobs jobs/*"
EVERYTHING_BELOW_CLI = (
    f"{JOBS} methods partition/* scenes render render/* picture calls calls/* server"
)

MAY_INCLUDE = {
    "base": "",
    "geometry": "base",
    "optimizer/readback": READBACK,
    "optimizer/energy": ENERGY,
    "optimizer/search": SEARCH,
    "optimizer/figures": FIGURES,
    "optimizer": FIT,
    "optimizer/sizing": SIZING,
    "optimizer/tracking": CORE,
    "methods": "base geometry",
    "partition": CORE,
    "partition/tracking": f"{CORE} partition",
    "partition/published": f"{CORE} methods partition",
    "partition/shipped": f"{CORE} methods partition",
    "scenes": "base geometry",
    "render": f"{CORE} partition scenes",
    "render/generator": f"{CORE} scenes render",
    "render/shipped": f"{CORE} partition partition/shipped scenes render",
    "proto": "lightfit",
    "wire": WIRE,
    "io/exr": WIRE,
    "io": f"{IO} io/exr",
    "jobs": IO,
    "jobs/schemes": f"{CORE} methods partition partition/* render render/shipped",
    "jobs/compare": f"{IO} jobs jobs/schemes methods partition/* render",
    "jobs/tune": f"{IO} jobs jobs/compare methods render render/generator",
    "jobs/shot": f"{IO} jobs",
    "picture": f"{JOBS} methods render",
    "calls": f"{IO} jobs",
    "calls/compare": f"{IO} jobs jobs/compare calls",
    "server": "base lightfit io calls calls/compare",
    "cli/flags": EVERYTHING_BELOW_CLI,
    "cli/reports": f"{EVERYTHING_BELOW_CLI} cli/flags",
    "cli": f"{EVERYTHING_BELOW_CLI} cli/*",
    "python": f"{IO} jobs calls calls/compare",
    "examples": f"{CORE} render render/generator lightfit",
    "fuzz": f"{IO} jobs scenes render calls calls/compare",
    "bench": f"{JOBS} methods partition/* scenes render render/* picture tests",
    "bench/service.cc": f"{JOBS} bench calls server tests",
    "tests": f"{EVERYTHING_BELOW_CLI} io/exr cli cli/*",
}

# Libraries that rooms must not know: what an engine links reads no files and speaks no protocol.
ROOMS_OF_AN_ENGINE = ("base", "geometry", "optimizer", "methods", "partition")
NOT_FOR_AN_ENGINE = re.compile(r"(OpenImageIO|OpenEXR|Imath|cairo|google/protobuf|CLI|grpc)")

INCLUDE = re.compile(r'^#include ["<]([^">]+)[">]')


def room_of(path: str) -> str:
    """The longest room that `path` begins with; "" for what is not of the project."""
    rooms = [room for room in MAY_INCLUDE if path == room or path.startswith(f"{room}/")]
    if path.startswith("lightfit/"):
        return "lightfit"
    return max(rooms, key=len, default="")


def allowed(room: str, target: str, rules: Dict[str, List[str]]) -> bool:
    return room == target or any(fnmatch.fnmatchcase(target, rule) for rule in rules[room])


def main() -> int:
    rules = {room: words.split() for room, words in MAY_INCLUDE.items()}
    num_faults = 0
    for folder in sorted({room.split("/")[0] for room in MAY_INCLUDE}):
        for path in sorted(pathlib.Path(folder).rglob("*")):
            if path.suffix not in (".h", ".cc"):
                continue
            room = room_of(path.as_posix())
            for number, line in enumerate(path.read_text().splitlines(), 1):
                found = INCLUDE.match(line)
                if not found:
                    continue
                target = room_of(found[1])
                fault = ""
                if target and not allowed(room, target, rules):
                    fault = f"{room} may include only: {MAY_INCLUDE[room] or room}"
                elif folder in ROOMS_OF_AN_ENGINE and NOT_FOR_AN_ENGINE.match(found[1]):
                    fault = f"{folder} knows nothing of files, pictures and protocols"
                if fault:
                    print(f"{path}:{number}: {line}\n    {fault}")
                    num_faults += 1
    return 1 if num_faults else 0


if __name__ == "__main__":
    sys.exit(main())
