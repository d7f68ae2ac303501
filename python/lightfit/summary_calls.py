"""The calls that look at a read-back without fitting it for use: summaries and comparisons."""

from __future__ import annotations

import os
from typing import Any, Iterable, List, Mapping, Optional, Sequence, Union

from lightfit.comparison import Comparison
from lightfit.cover import FineCover
from lightfit.errors import InvalidArgumentError, error_of
from lightfit.exr import read_exr
from lightfit.inputs import (
    AnyCamera,
    Lights,
    MapSize,
    Options,
    Path_,
    map_size_message,
    options_message,
)
from lightfit.plan_calls import PlanCalls
from lightfit.request import Candidate, ReadbackParts, optional_parts, readback_parts
from lightfit.result import FitResult
from lightfit.summary import FrameSummary, Summary, add_summaries
from lightfit.v1 import service_pb2

# The caller's matrices: of a result, or one by one.
Matrices = Union[FitResult, Iterable[Candidate]]


class SummaryCalls(PlanCalls):
    """Arguments that calls share: see Calls."""

    def summarize(
        self,
        depth: Any = None,
        shadow: Any = None,
        camera: Optional[AnyCamera] = None,
        lights: Optional[Lights] = None,
        *,
        summaries: Sequence[Summary] = (),
        weigh_by: Optional[Matrices] = None,
        options: Optional[Options] = None,
        facing: Any = None,
        mapped: Any = None,
        background: Optional[float] = None,
        number: Optional[float] = None,
        source: str = "",
        timeout_s: Optional[float] = None,
        request_id: Optional[str] = None,
    ) -> FrameSummary:
        """What a read-back has to say about its lights, in some kilobytes: for `fit_summary`, which
        finds one matrix per light for all the frames whose summaries it is given.

        depth, shadow, camera, lights, facing, mapped, background: as for `fit`; none with summaries
            alone.
        number: of the frame on the time line, so that none is counted twice. None: not known; frames
            of the same depth and camera are then taken for one.
        summaries: to be added to it: results of `summarize`, files by name, or their bytes.
        weigh_by: the l1 metrics weigh samples by a map: each light's own best of this read-back, or
            these, a FitResult of a first round or Candidates, one for each light.
        options: of samples, metric, cover and border, as for `fit`.
        source: names the frame in messages.

            total = lightfit.summarize(summaries=[lightfit.summarize(*frame) for frame in frames])
            result = lightfit.fit_summary([total], (2048, 2048))
        """
        given = optional_parts(
            depth, shadow, camera, lights, source, facing, mapped, None, background
        )
        return self._summarize(given, number, summaries, weigh_by, options, timeout_s, request_id)

    def summarize_exr(
        self,
        path: Path_,
        lights: Lights,
        *,
        number: Optional[float] = None,
        summaries: Sequence[Summary] = (),
        weigh_by: Optional[Matrices] = None,
        options: Optional[Options] = None,
        timeout_s: Optional[float] = None,
        request_id: Optional[str] = None,
        **exr: Any,
    ) -> FrameSummary:
        """`summarize` of an EXR read-back, as `lightfit summarize PATH --lights LIGHTS` does it.

        exr: as for `fit_exr`. Lights without a shadow channel are refused: leave them out of lights.
        """
        parts = _exr_parts(path, lights, exr)
        # Folders differ between the machines of a farm, and would make files differ.
        parts.header.source = os.path.basename(os.fspath(path))
        return self._summarize(parts, number, summaries, weigh_by, options, timeout_s, request_id)

    def compare(
        self,
        depth: Any,
        shadow: Any,
        camera: AnyCamera,
        lights: Lights,
        map_size: MapSize,
        *,
        given: Optional[Mapping[str, Matrices]] = None,
        options: Optional[Options] = None,
        facing: Any = None,
        mapped: Any = None,
        cover: Optional[FineCover] = None,
        background: Optional[float] = None,
        source: str = "",
        timeout_s: Optional[float] = None,
        request_id: Optional[str] = None,
    ) -> Comparison:
        """Every published way to set up a shadow map beside ours: energies, footprints, and the
        shares of wrong pixels that the read-back foretells.

        given: the caller's own, by the name of the method: a FitResult, or Candidates, at most one
            for each light.
        options: of the method "lightfit", as for `fit`.
        The rest: as for `fit`. True wrong pixels need the scene: `lightfit compare SCENE`.

            print(lightfit.compare(depth, shadow, camera, lights, (1024, 1024)))
        """
        parts = readback_parts(
            depth, shadow, camera, lights, source, facing, mapped, cover, background
        )
        return self._compare(parts, map_size, given, options, timeout_s, request_id)

    def compare_exr(
        self,
        path: Path_,
        lights: Lights,
        map_size: MapSize,
        *,
        given: Optional[Mapping[str, Matrices]] = None,
        options: Optional[Options] = None,
        timeout_s: Optional[float] = None,
        request_id: Optional[str] = None,
        **exr: Any,
    ) -> Comparison:
        """`compare` of an EXR read-back, as `lightfit compare PATH --lights LIGHTS` does it.

        exr: as for `fit_exr`. Lights without a shadow channel are refused: leave them out of lights.
        """
        parts = _exr_parts(path, lights, exr)
        return self._compare(parts, map_size, given, options, timeout_s, request_id)

    def _summarize(
        self,
        parts: Optional[ReadbackParts],
        number: Optional[float],
        summaries: Sequence[Summary],
        weigh_by: Optional[Matrices],
        options: Optional[Options],
        timeout_s: Optional[float],
        request_id: Optional[str],
    ) -> FrameSummary:
        request = service_pb2.SummarizeRequest(options=options_message(options))
        if parts is not None:
            request.readback.CopyFrom(parts.header)
            request.lights.extend(parts.lights)
            parts.pixels.fill(request.readback)
        if number is not None:
            request.frame_number = float(number)
        add_summaries(summaries, request)
        if weigh_by is not None:
            request.weigh_by.extend(_candidates("weigh_by", weigh_by))
        return FrameSummary.of(self._call("Summarize", request, timeout_s, request_id))

    def _compare(
        self,
        parts: ReadbackParts,
        map_size: MapSize,
        given: Optional[Mapping[str, Matrices]],
        options: Optional[Options],
        timeout_s: Optional[float],
        request_id: Optional[str],
    ) -> Comparison:
        request = service_pb2.CompareRequest(
            readback=parts.header,
            lights=parts.lights,
            map=map_size_message(map_size),
            options=options_message(options),
        )
        for name, matrices in (given or {}).items():
            field = f"given[{name!r}]"
            request.given.add(name=name, matrices=_candidates(field, matrices))
        parts.pixels.fill(request.readback)
        return Comparison.of(self._call("Compare", request, timeout_s, request_id))


def _exr_parts(path: Path_, lights: Lights, exr: Mapping[str, Any]) -> ReadbackParts:
    """Of a read-back that has all of the lights."""
    readback = read_exr(path, lights, **exr)
    for light, status in zip(readback.lights, readback.light_status):
        if status.code != 0:
            raise error_of(status.code, f'{status.message}; or leave "{light.name}" out of lights')
    return readback.parts()


def _candidates(field: str, matrices: Matrices) -> List[service_pb2.CandidateMatrix]:
    """Of a result those of the lights that have one."""
    if isinstance(matrices, FitResult):
        several = [light.name for light in matrices.lights if light.plan and len(light.plan.maps) > 1]
        if several:
            raise InvalidArgumentError(
                f"{field}: light \"{several[0]}\" has several maps, want the result of `fit`"
            )
        return [
            service_pb2.CandidateMatrix(
                light=light.name,
                map_from_world=light.message.map_from_world,
                map=light.message.map,
            )
            for light in matrices.lights
            if light.ok
        ]
    messages = []
    for index, candidate in enumerate(matrices):
        if not isinstance(candidate, Candidate):
            raise InvalidArgumentError(
                f"{field}[{index}]: is a {type(candidate).__name__}, want lightfit.Candidate, such "
                'as Candidate.map("sun", map_from_world, (1024, 1024)); or a FitResult as a whole'
            )
        messages.append(candidate.message)
    return messages
