"""What any number of read-backs have to say about their lights, in some kilobytes."""

from __future__ import annotations

import dataclasses
import os
import tempfile
import warnings
from pathlib import Path
from typing import Dict, Sequence, Union

from lightfit.errors import Code, InvalidArgumentError, LightfitWarning
from lightfit.inputs import Path_
from lightfit.v1 import service_pb2, summary_pb2


@dataclasses.dataclass(frozen=True)
class SummarizedLight:
    """One light in all the frames of a summary."""

    name: str
    frames: int  # that have something of it
    frames_without: int  # that have nothing of it
    reason: str  # why, in one of those; names the frame
    samples: int


@dataclasses.dataclass(frozen=True, eq=False)
class FrameSummary:
    """One read-back, or several added up; for `fit_summary`, `allocate`, and `summarize`, which adds
    up. The same frames give the same bytes, in whatever order they were added."""

    data: bytes  # what `lightfit summarize` writes to a file
    message: summary_pb2.SummaryFile = dataclasses.field(repr=False)

    @property
    def lights(self) -> Dict[str, SummarizedLight]:
        """By name."""
        return {
            light.light.name: SummarizedLight(
                light.light.name,
                light.total.num_frames,
                light.num_frames_without,
                light.failure.message.decode(errors="replace")
                or (Code.name_of(light.failure.code) if light.failure.code else ""),
                light.total.counts.used,
            )
            for light in self.message.lights
        }

    def save(self, path: Path_) -> None:
        """Writes the file that `lightfit fit --summary` and others read, in one step."""
        folder = os.path.dirname(os.path.abspath(path))
        try:
            handle, name = tempfile.mkstemp(dir=folder)
            with os.fdopen(handle, "wb") as file:
                file.write(self.data)
            os.chmod(name, 0o666 & ~_umask())
            os.replace(name, path)
        except OSError as error:
            raise InvalidArgumentError(f"{os.fspath(path)}: {error.strerror}") from None

    @classmethod
    def of(cls, message: service_pb2.SummarizeResult) -> "FrameSummary":
        for text in message.warnings:
            warnings.warn(text, LightfitWarning, stacklevel=4)
        return cls(message.summary_file, message.summary)


# The path of a file of `lightfit summarize`, its bytes, or its message.
Summary = Union[FrameSummary, str, "os.PathLike[str]", bytes, summary_pb2.SummaryFile]


def add_summaries(
    summaries: Sequence[Summary],
    request: Union[
        service_pb2.FitSummaryRequest, service_pb2.AllocateRequest, service_pb2.SummarizeRequest
    ],
) -> None:
    if isinstance(summaries, (str, bytes, os.PathLike, FrameSummary, summary_pb2.SummaryFile)):
        raise InvalidArgumentError("summaries: is one summary, want a list of them: [summary]")
    for index, summary in enumerate(summaries):
        if isinstance(summary, FrameSummary):
            request.summary_files.append(summary.data)
        elif isinstance(summary, summary_pb2.SummaryFile):
            request.summaries.append(summary)
        elif isinstance(summary, bytes):
            request.summary_files.append(summary)
        elif isinstance(summary, (str, os.PathLike)):
            try:
                request.summary_files.append(Path(summary).read_bytes())
            except OSError as error:
                raise InvalidArgumentError(f"{summary}: {error.strerror}") from None
        else:
            raise InvalidArgumentError(
                f"summaries[{index}]: is a {type(summary).__name__}, want the result of "
                "lightfit.summarize, the name of a file of lightfit summarize, or its bytes"
            )


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
