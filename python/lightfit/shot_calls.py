"""Whole shots, made of the calls for single frames."""

from __future__ import annotations

import dataclasses
from typing import Any, Dict, Iterable, Iterator, List, Optional, Sequence

from lightfit.inputs import (
    Clip,
    Lights,
    MapSize,
    Options,
    clip_message,
    map_size_message,
    options_message,
)
from lightfit.request import (
    evaluate_request,
    fit_request,
    summary_request,
    track_setup,
)
from lightfit.result import FitResult
from lightfit.shots import (
    AnyFrame,
    FrameParts,
    ShotStep,
    check_frames,
    chosen_modes,
    parts_of_frames,
)
from lightfit.summary import FrameSummary
from lightfit.summary_calls import SummaryCalls
from lightfit.v1 import (
    matrix_pb2,
    options_pb2,
    readback_pb2,
    result_pb2,
    service_pb2,
    shot_pb2,
)

# Further rounds of weighing are not worth their reading below this share of the energy.
_LEAST_GAIN = 1e-4

# Summaries are added up before there are more of them.
_ADDED_AT_ONCE = 256

_L1 = (
    options_pb2.METRIC_UNSPECIFIED,  # the default is one
    options_pb2.METRIC_L1,
    options_pb2.METRIC_L1_ACROSS_EDGE,
)

_MODE_NUMBERS = {
    "per-frame": shot_pb2.SHOT_MODE_PER_FRAME,
    "tracked": shot_pb2.SHOT_MODE_TRACKED,
    "per-shot": shot_pb2.SHOT_MODE_PER_SHOT,
}


@dataclasses.dataclass
class _Job:
    """What all frames share."""

    size: MapSize
    options: options_pb2.FitOptions
    clip: Clip
    step: int
    timeout_s: Optional[float]
    request_id: Optional[str]


@dataclasses.dataclass
class _Before:
    """The frame before, that crawl is measured to."""

    number: int = 0
    readback: Optional[readback_pb2.Readback] = None
    maps: Dict[str, matrix_pb2.Matrix4x4] = dataclasses.field(default_factory=dict)  # by light


class ShotCalls(SummaryCalls):
    """Arguments that calls share: see Calls."""

    def shot(
        self,
        frames: Iterable[AnyFrame],
        lights: Optional[Lights],
        map_size: MapSize,
        *,
        modes: Sequence[str] = ("per-frame", "tracked", "per-shot"),
        stability: Optional[float] = None,
        tracker: Optional[shot_pb2.TrackerSettings] = None,
        rounds: int = 2,
        step: int = 1,
        options: Optional[Options] = None,
        clip: Clip = "vulkan",
        timeout_s: Optional[float] = None,
        request_id: Optional[str] = None,
    ) -> Iterator[ShotStep]:
        """Every frame by itself, tracked, and one matrix per light for all of them: what `lightfit
        shot` writes, step by step as it is found. Nothing is done before the first step is asked
        for, and a frame is looked at when its turn comes.

        frames: `Frame(depth, shadow, camera)` objects, results of `read_exr`, or
            `ExrFrames(paths, lights)`, which reads them; in their order. The mode "per-shot" goes
            over them several times, so that an iterator that ends will not do for it.
        lights: of all frames that do not have their own.
        modes: some of "per-frame", "tracked", "per-shot". The first two come frame by frame; then
            the matrices of the whole shot, a step without a frame, and each frame's figures in them.
            One matrix cannot serve a light that moves: without "per-shot" lights may.
        stability, tracker: as for `track`.
        rounds: the l1 metrics: how often the samples are weighed anew for the whole shot, in its own
            map.
        step: how far the numbers of neighbouring frames are apart; where it is more, frames are
            missing, and no crawl is measured over the gap.
        map_size, options, clip: as for `fit`. timeout_s: of each call that this takes.

            for step in lightfit.shot(frames, lights, (1024, 1024), modes=("tracked",)):
                print(step.frame, step.result["sun"].action)
        """
        wanted = chosen_modes(modes)
        check_frames(frames, wanted)
        map_size_message(map_size)
        clip_message(clip)
        fit_options = options_message(options) or options_pb2.FitOptions()
        job = _Job(map_size, fit_options, clip, step, timeout_s, request_id)
        setup = track_setup(map_size, stability, tracker, fit_options, clip, ())
        return self._steps(frames, lights, wanted, setup, rounds, job)

    def _steps(
        self,
        frames: Iterable[AnyFrame],
        lights: Optional[Lights],
        modes: List[str],
        setup: service_pb2.TrackSetup,
        rounds: int,
        job: _Job,
    ) -> Iterator[ShotStep]:
        before = {mode: _Before() for mode in modes}
        summaries: List[FrameSummary] = []
        track = None
        if "tracked" in modes:
            track = self._track(setup, job.timeout_s, job.request_id)
        try:
            for frame in parts_of_frames(frames, lights):
                if "per-frame" in modes:
                    request = fit_request(frame.parts, job.size, job.options, job.clip, True)
                    fitted = self._fit(request, frame.parts.pixels, job.timeout_s, job.request_id)
                    yield self._judged("per-frame", frame, fitted, before["per-frame"], job)
                if track is not None:
                    tracked = track.update_parts(frame.number, frame.parts).message
                    yield self._judged("tracked", frame, tracked, before["tracked"], job)
                if "per-shot" in modes:
                    summaries.append(self._summary_of(frame, None, job))
                    if len(summaries) >= _ADDED_AT_ONCE:
                        summaries = [self.summarize(summaries=summaries)]
        finally:
            if track is not None:
                track.close()
        if "per-shot" not in modes:
            return
        whole = self._whole(frames, lights, summaries, rounds, job)
        yield ShotStep("per-shot", None, None, FitResult.of(whole))
        for frame in parts_of_frames(frames, lights):
            here = result_pb2.FitResult()
            here.CopyFrom(whole)
            yield self._judged("per-shot", frame, here, before["per-shot"], job)

    def _summary_of(
        self, frame: FrameParts, weigh_by: Optional[FitResult], job: _Job
    ) -> FrameSummary:
        return self._summarize(
            frame.parts, frame.number, (), weigh_by, job.options, job.timeout_s, job.request_id
        )

    def _whole(
        self,
        frames: Iterable[AnyFrame],
        lights: Optional[Lights],
        summaries: List[FrameSummary],
        rounds: int,
        job: _Job,
    ) -> result_pb2.FitResult:
        """One matrix per light. The sum weighs each frame's samples in that frame's best map; for
        the l1 metrics they are weighed in the shot's map, summed and fitted anew, and the best map
        by the true sum of footprints is kept."""
        fitted = self._fit_sum(summaries, job)
        order = [light.name for light in self._first_lights(frames, lights)]
        best = {light.name: light for light in fitted.lights}
        least: Dict[str, float] = {}
        for _ in range(rounds + 1 if job.options.metric in _L1 else 0):
            result = FitResult.of(fitted)
            totals: List[FrameSummary] = []
            for frame in parts_of_frames(frames, lights):
                totals.append(self._summary_of(frame, result, job))
                if len(totals) >= _ADDED_AT_ONCE:
                    totals = [self.summarize(summaries=totals)]
            total = self.summarize(summaries=totals)
            sums = {
                light.light.name: light.total.footprint_sum.parts
                for light in total.message.lights
                if light.total.num_frames > 0
            }
            gains = False
            for light in fitted.lights:
                if light.status.code != 0 or light.name not in sums:
                    continue
                energy = sums[light.name][0] if sums[light.name] else 0.0
                light.energies.final = energy
                _put_ratio(light.energies)
                held = least.get(light.name)
                gains = gains or held is None or energy < (1.0 - _LEAST_GAIN) * held
                if held is None or energy < held:
                    least[light.name] = energy
                    best[light.name] = light
            if not gains:
                break
            fitted = self._fit_sum([total], job)
        whole = result_pb2.FitResult()
        whole.CopyFrom(fitted)
        del whole.lights[:]
        whole.lights.extend(best[name] for name in order)
        whole.shot.mode = shot_pb2.SHOT_MODE_PER_SHOT
        return whole

    def _fit_sum(self, summaries: List[FrameSummary], job: _Job) -> result_pb2.FitResult:
        # What the samples were summed by is in the summaries.
        request = summary_request(summaries, job.size, job.options, job.clip)
        answer: result_pb2.FitResult = self._call(
            "FitSummary", request, job.timeout_s, job.request_id
        )
        return answer

    def _first_lights(
        self, frames: Iterable[AnyFrame], lights: Optional[Lights]
    ) -> Iterable[Any]:
        for frame in parts_of_frames(frames, lights):
            return frame.parts.lights
        return ()

    def _judged(
        self,
        mode: str,
        frame: FrameParts,
        result: result_pb2.FitResult,
        before: _Before,
        job: _Job,
    ) -> ShotStep:
        """The matrices with their figures on this frame, by one measure for all modes, and their
        crawl; from then on this is the frame before."""
        if before.readback is not None and frame.number - before.number > job.step:
            before.readback, before.maps = None, {}
        readback = readback_pb2.Readback()
        readback.CopyFrom(frame.parts.header)
        frame.parts.pixels.fill(readback)
        for border in (matrix_pb2.BORDER_LIT, matrix_pb2.BORDER_DARK):
            self._put_figures(border, frame, result, before, job)
        for light in result.lights:
            if mode == "per-shot" and light.status.code == 0:  # nothing was searched here
                light.energies.start = light.energies.final
                light.evaluations = 0
                light.stop_reason = result_pb2.STOP_REASON_NO_SEARCH
                del light.trace[:]
            _put_ratio(light.energies)
        result.readback.source = frame.parts.header.source
        result.readback.camera.CopyFrom(frame.parts.header.camera)
        result.shot.mode = _MODE_NUMBERS[mode]
        result.shot.number = frame.number
        before.number, before.readback = frame.number, readback
        before.maps = {
            light.name: light.map_from_world for light in result.lights if light.status.code == 0
        }
        return ShotStep(mode, frame.number, frame.index, FitResult.of(result))

    def _put_figures(
        self,
        border: int,
        frame: FrameParts,
        result: result_pb2.FitResult,
        before: _Before,
        job: _Job,
    ) -> None:
        """Of the lights whose maps have this border."""
        fitted = [
            light for light in result.lights if light.status.code == 0 and light.border == border
        ]
        if not fitted:
            return
        options = options_pb2.FitOptions()
        options.CopyFrom(job.options)
        options.border = (
            options_pb2.BORDER_CHOICE_DARK
            if border == matrix_pb2.BORDER_DARK
            else options_pb2.BORDER_CHOICE_LIT
        )
        request = evaluate_request(frame.parts, (), options)
        for light in fitted:
            candidate = request.matrices.add(
                light=light.name, map_from_world=light.map_from_world, map=light.map
            )
            if light.name in before.maps:
                candidate.map_from_world_before.CopyFrom(before.maps[light.name])
        if before.readback is not None:
            request.before.CopyFrom(before.readback)
        answer = self._call("Evaluate", request, job.timeout_s, job.request_id)
        result.options.compute_statistics = answer.options.compute_statistics
        for light, evaluation in zip(fitted, answer.evaluations):
            if evaluation.status.code != 0:
                failed = result_pb2.LightResult(name=light.name, status=evaluation.status)
                failed.map.CopyFrom(light.map)
                failed.light.CopyFrom(light.light)
                light.CopyFrom(failed)
                continue
            light.energies.final = evaluation.energy
            light.footprint.CopyFrom(evaluation.footprint)
            light.samples.CopyFrom(evaluation.samples)
            light.foretold_wrong.final = evaluation.wrong_share
            light.shot.ClearField("crawl")
            if evaluation.HasField("crawl"):
                light.shot.crawl.CopyFrom(evaluation.crawl)


def _put_ratio(energies: result_pb2.Energies) -> None:
    if energies.start > 0.0:
        energies.final_over_start = energies.final / energies.start
