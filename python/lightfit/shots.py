"""The frames of a shot, and what comes of them."""

from __future__ import annotations

import dataclasses
import os
import re
from typing import Any, Iterable, Iterator, List, Optional, Sequence, Union

from lightfit.errors import InvalidArgumentError, error_of
from lightfit.exr import ExrReadback, read_exr
from lightfit.inputs import AnyCamera, Lights, Path_
from lightfit.request import ReadbackParts, readback_parts
from lightfit.result import FitResult
from lightfit.words import chosen

MODES = ("per-frame", "tracked", "per-shot")


@dataclasses.dataclass(frozen=True, eq=False)
class Frame:
    """One frame; its fields as the arguments of `fit`. lights: None for those of the shot. number:
    on the time line; None: one more than the frame before, from 1."""

    depth: Any
    shadow: Any
    camera: AnyCamera
    number: Optional[int] = None
    lights: Optional[Lights] = None
    facing: Any = None
    mapped: Any = None
    background: Optional[float] = None
    source: str = ""


AnyFrame = Union[Frame, ExrReadback]


class ExrFrames:
    """Frames in EXR files, each read when its turn comes, as often as it does; for `shot`.

    paths: in their order. lights: as for `fit`. exr: the further arguments of `read_exr`.
    """

    def __init__(self, paths: Iterable[Path_], lights: Lights, **exr: Any) -> None:
        self.paths: List[Path_] = list(paths)
        self._lights = lights
        self._exr = exr

    def __len__(self) -> int:
        return len(self.paths)

    def __iter__(self) -> Iterator[ExrReadback]:
        for path in self.paths:
            yield read_exr(path, self._lights, **self._exr)


@dataclasses.dataclass(frozen=True, eq=False)
class ShotStep:
    """What has just been found: one frame in one mode; or, with frame None, the matrices of the whole
    shot, whose frames follow."""

    mode: str  # "per-frame", "tracked" or "per-shot"
    frame: Optional[int]  # its number
    index: Optional[int]  # in `frames`, from 0

    # Energies, footprints and foretold wrong pixels are of this frame; LightResult.action of tracked
    # ones says what became of the matrix. result.message.lights[i].shot.crawl is the crawl from the
    # frame before.
    result: FitResult


@dataclasses.dataclass(frozen=True)
class FrameParts:
    """A frame on its way."""

    index: int
    number: int
    parts: ReadbackParts


def chosen_modes(modes: Sequence[str]) -> List[str]:
    """In the order of MODES."""
    if isinstance(modes, str):
        modes = (modes,)
    wanted = {chosen("modes", mode, MODES, {}) for mode in modes}
    if not wanted:
        raise InvalidArgumentError(f"modes: none, want some of {', '.join(MODES)}")
    return [mode for mode in MODES if mode in wanted]


def check_frames(frames: Any, modes: Sequence[str]) -> None:
    if isinstance(frames, (Frame, ExrReadback)):
        raise InvalidArgumentError("frames: is one frame, want a list of them: [frame]")
    if not isinstance(frames, Iterable):
        raise InvalidArgumentError(
            f"frames: is a {type(frames).__name__}, want a list of lightfit.Frame or "
            "lightfit.ExrFrames(paths, lights)"
        )
    if "per-shot" in modes and iter(frames) is frames:
        raise InvalidArgumentError(
            "frames: is an iterator, which ends after one round, and the mode per-shot goes over "
            "the frames several times: want a list, lightfit.ExrFrames(paths, lights), or another "
            "object whose __iter__ begins anew; or modes=(\"per-frame\", \"tracked\")"
        )


def parts_of_frames(frames: Iterable[AnyFrame], lights: Optional[Lights]) -> Iterator[FrameParts]:
    """One at a time. An error says which frame it belongs to."""
    number = 0
    for index, frame in enumerate(frames):
        try:
            if isinstance(frame, ExrReadback):
                parts, given = _parts_of_exr(frame), _number_of(frame.path)
            elif isinstance(frame, Frame):
                parts, given = _parts_of_arrays(frame, lights), frame.number
            else:
                raise InvalidArgumentError(
                    f"is a {type(frame).__name__}, want lightfit.Frame or the result of read_exr"
                )
        except InvalidArgumentError as error:
            raise InvalidArgumentError(f"frames[{index}]: {error.message}") from None
        following = number + 1
        number = following if given is None else int(given)
        if index > 0 and number < following:
            raise InvalidArgumentError(
                f"frames[{index}]: number = {number} after {following - 1}, want them in order"
            )
        yield FrameParts(index, number, parts)


def _parts_of_arrays(frame: Frame, lights: Optional[Lights]) -> ReadbackParts:
    own = lights if frame.lights is None else frame.lights
    if own is None:
        raise InvalidArgumentError("lights: none, want those of the shot, or of each frame")
    return readback_parts(
        frame.depth,
        frame.shadow,
        frame.camera,
        own,
        frame.source,
        frame.facing,
        frame.mapped,
        None,
        frame.background,
    )


def _parts_of_exr(frame: ExrReadback) -> ReadbackParts:
    for light, status in zip(frame.lights, frame.light_status):
        if status.code != 0:
            raise error_of(status.code, f'{status.message}; or leave "{light.name}" out of lights')
    return frame.parts()


def _number_of(path: str) -> Optional[int]:
    """The digits at the end of the file's name, and a minus that is no part of the words."""
    stem = os.path.splitext(os.path.basename(path))[0]
    digits = re.search(r"(?:^|(?<=[._ ]))-?\d+$|\d+$", stem)
    return int(digits.group()) if digits else None
