"""Words for choices, as the command line and the schema spell them: "reversed-z", "Reversed_Z"."""

from __future__ import annotations

import difflib
from typing import Any, Dict, Iterable, List, Mapping, Tuple

from lightfit.errors import InvalidArgumentError
from lightfit.v1 import camera_pb2, matrix_pb2

# Names as `lightfit fit --clip` has them: depth range, and whether y = +1 is the map's first row.
CLIPS: Dict[str, Tuple[int, bool]] = {
    "vulkan": (matrix_pb2.ClipConvention.DEPTH_RANGE_ZERO_TO_ONE, False),
    "direct3d": (matrix_pb2.ClipConvention.DEPTH_RANGE_ZERO_TO_ONE, True),
    "opengl": (matrix_pb2.ClipConvention.DEPTH_RANGE_MINUS_ONE_TO_ONE, False),
    "reversed-z": (matrix_pb2.ClipConvention.DEPTH_RANGE_REVERSED_ZERO_TO_ONE, False),
    "direct3d-reversed": (matrix_pb2.ClipConvention.DEPTH_RANGE_REVERSED_ZERO_TO_ONE, True),
}

# What else people call them; as wire/matrix_proto.cc.
CLIP_ALIASES: Dict[str, str] = {
    **dict.fromkeys(("vk",), "vulkan"),
    **dict.fromkeys(
        ("d3d", "d3d11", "d3d12", "directx", "dx", "dx11", "dx12", "metal", "webgpu"), "direct3d"
    ),
    **dict.fromkeys(("gl", "gles", "webgl"), "opengl"),
    **dict.fromkeys(("vulkan-reversed",), "reversed-z"),
    **dict.fromkeys(
        ("d3d-reversed", "directx-reversed", "metal-reversed", "webgpu-reversed"),
        "direct3d-reversed",
    ),
}

DEPTH_KINDS: Dict[str, int] = {
    "camera-z": camera_pb2.DEPTH_KIND_CAMERA_Z,
    "distance": camera_pb2.DEPTH_KIND_DISTANCE,
    "ndc-0-1": camera_pb2.DEPTH_KIND_NDC_ZERO_TO_ONE,
    "ndc-minus-1-1": camera_pb2.DEPTH_KIND_NDC_MINUS_ONE_TO_ONE,
    "ndc-reversed": camera_pb2.DEPTH_KIND_NDC_REVERSED_ZERO_TO_ONE,
}

DEPTH_KIND_ALIASES: Dict[str, str] = {
    "ndc-zero-to-one": "ndc-0-1",
    "ndc-minus-one-to-one": "ndc-minus-1-1",
    "ndc-reversed-zero-to-one": "ndc-reversed",
}

# Words of the command line that the schema spells out, by field of FitOptions.
_LONG_WORDS: Dict[str, Dict[str, str]] = {
    "metric": {"l2-edge": "l2-across-edge", "l1-edge": "l1-across-edge"},
    "search": {"line": "rotation-line-search", "refine": "rotation-line-search-refined"},
    "affine": {
        "rectangle": "min-area-rectangle",
        "cgal-rectangle": "min-area-rectangle-cgal",
        "skewed": "skewed-rectangle",
        "parallelogram": "min-energy-parallelogram",
    },
    "border": {"auto": "automatic"},
}


def canonical(word: str) -> str:
    """In lower case, with - between its parts."""
    return "-".join(word.lower().replace("_", " ").replace("-", " ").split())


def chosen(field: str, word: Any, words: Iterable[str], aliases: Mapping[str, str]) -> str:
    """The one of `words` that is meant."""
    known = list(words)
    if isinstance(word, str):
        name = canonical(word)
        name = aliases.get(name, name)
        if name in known:
            return name
    raise InvalidArgumentError(
        f"{field} = {word!r}, want one of {', '.join(known)}{_did_you_mean(word, known)}"
    )


def enum_word(field: Any, word: str) -> str:
    """The schema's name of a value of an enum of FitOptions, such as METRIC_L1_ACROSS_EDGE for
    "l1-edge"; the name itself is taken, too. field: its descriptor."""
    values = field.enum_type.values_by_name
    prefix: str = field.enum_type.values_by_number[0].name[: -len("UNSPECIFIED")]
    long_words = _LONG_WORDS.get(field.name, {})
    short = canonical(word)
    short_prefix = canonical(prefix) + "-"
    if short.startswith(short_prefix):
        short = short[len(short_prefix) :]
    name: str = prefix + long_words.get(short, short).upper().replace("-", "_")
    if name in values and name != f"{prefix}UNSPECIFIED":
        return name
    spelled = {long: brief for brief, long in long_words.items()}
    known: List[str] = []
    for value in field.enum_type.values[1:]:
        long_word = canonical(value.name[len(prefix) :])
        known.append(spelled.get(long_word, long_word))
    raise InvalidArgumentError(
        f"options: {field.name} = {word!r}, want one of {', '.join(known)}"
        f"{_did_you_mean(word, known)}"
    )


def check_fields(what: str, names: Iterable[str], descriptor: Any) -> None:
    """That a message has fields of these names, in its own spelling or that of JSON."""
    known = [field.name for field in descriptor.fields]
    spelled = set(known) | {field.json_name for field in descriptor.fields}
    for name in names:
        if name not in spelled:
            raise InvalidArgumentError(
                f'{what}: there is no "{name}", want some of {", ".join(known)}'
                f"{_did_you_mean(name, known)}"
            )


def _did_you_mean(word: Any, known: List[str]) -> str:
    if not isinstance(word, str):
        return ""
    near = difflib.get_close_matches(canonical(word), [canonical(name) for name in known], 1)
    if not near:
        return ""
    return f'; did you mean "{next(name for name in known if canonical(name) == near[0])}"?'
