"""Who answers requests: this process or a server. What the calls are made of."""

from __future__ import annotations

import abc
from typing import Any, Mapping, Optional

from lightfit.exr import ExrReadback, read_exr
from lightfit.inputs import Clip, Lights, Options, Path_
from lightfit.pixels import Pixels
from lightfit.request import SizeOrPlan, fit_request
from lightfit.result import FitResult
from lightfit.tracks import Track
from lightfit.v1 import result_pb2, service_pb2


class Answers(abc.ABC):
    """A message for a message."""

    @abc.abstractmethod
    def _fit(
        self,
        request: service_pb2.FitRequest,
        pixels: Pixels,
        timeout_s: Optional[float],
        request_id: Optional[str],
    ) -> result_pb2.FitResult:
        """The request has no pixels yet."""

    @abc.abstractmethod
    def _call(
        self, method: str, request: Any, timeout_s: Optional[float], request_id: Optional[str]
    ) -> Any:
        """A call of one request and one result: "FitSummary", "Evaluate", "Allocate" ...."""

    @abc.abstractmethod
    def _track(
        self,
        setup: service_pb2.TrackSetup,
        timeout_s: Optional[float],
        request_id: Optional[str],
    ) -> Track: ...

    def _fit_exr(
        self,
        path: Path_,
        lights: Lights,
        size: SizeOrPlan,
        options: Optional[Options],
        clip: Clip,
        foretell_wrong: bool,
        timeout_s: Optional[float],
        request_id: Optional[str],
        exr: Mapping[str, Any],
    ) -> FitResult:
        readback = read_exr(path, lights, **exr)
        parts = readback.parts()
        request = fit_request(parts, size, options, clip, foretell_wrong)
        message = self._fit(request, parts.pixels, timeout_s, request_id)
        _put_light_status(readback, message)
        message.readback.origin.CopyFrom(readback.origin)
        return FitResult.of(message)


def _put_light_status(readback: ExrReadback, result: result_pb2.FitResult) -> None:
    """Lights whose shadow could not be read went along without any; what is wrong is that."""
    for light, status in zip(result.lights, readback.light_status):
        if status.code == 0:
            continue
        failed = result_pb2.LightResult(name=light.name, status=status)
        if light.HasField("map"):
            failed.map.CopyFrom(light.map)
        if light.HasField("light"):
            failed.light.CopyFrom(light.light)
        light.CopyFrom(failed)
