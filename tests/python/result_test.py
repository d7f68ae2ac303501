"""Dataclasses over result messages."""

import numpy
import pytest

import lightfit
from lightfit.v1 import allocation_pb2, matrix_pb2, result_pb2, shot_pb2


def message() -> result_pb2.FitResult:
    result = result_pb2.FitResult()
    sun = result.lights.add(name="sun", evaluations=7)
    sun.status.code = 0
    sun.map.width, sun.map.height = 64, 32
    sun.map_from_world.m.extend(range(16))
    sun.clip_from_world.m.extend(range(16, 32))
    sun.border = matrix_pb2.BORDER_DARK  # type: ignore[assignment]
    sun.facing = result_pb2.FACING_SOURCE_GIVEN  # type: ignore[assignment]
    sun.energies.final = 2.5
    sun.footprint.rms = 1.5
    sun.samples.used = 9
    sun.stop_reason = result_pb2.STOP_REASON_CONVERGED  # type: ignore[assignment]
    key = result.lights.add(name="key")
    key.status.code = 9
    key.status.message = "receivers surround it: want a cube map"
    return result


def test_a_light_has_matrices_and_figures() -> None:
    light = lightfit.FitResult.of(message())["sun"]
    assert light.ok and light.map_size == (64, 32)
    assert light.map_from_world is not None and light.map_from_world.dtype == numpy.float64
    assert light.map_from_world.tolist() == numpy.arange(16.0).reshape(4, 4).tolist()
    assert light.clip_from_world is not None and light.clip_from_world[0, 0] == 16
    assert (light.energy, light.evaluations, light.stop_reason) == (2.5, 7, "CONVERGED")
    assert light.footprint == lightfit.Footprint(1.5, None, None, None)
    assert light.samples is not None and light.samples.used == 9
    assert (light.border, light.facing) == ("dark", "given")
    assert light.foretold_wrong is None and light.action is None and light.frames_kept is None


def test_a_light_that_failed_has_its_status_alone() -> None:
    result = lightfit.FitResult.of(message())
    assert not result.ok
    light = result.lights[1]
    assert (light.status.code, str(light.status)) == (
        "FAILED_PRECONDITION",
        "receivers surround it: want a cube map",
    )
    assert light.map_from_world is None and light.clip_from_world is None
    assert light.energy is None and light.footprint is None and light.samples is None
    assert light.border is None and light.facing is None
    with pytest.raises(lightfit.FailedPreconditionError, match='^light "key": receivers surround'):
        result.raise_for_status()


# As a frame without a frame before it has: a crawl, or nothing, and no word on the plan.
def test_a_plan_keeps_its_maps_where_the_shot_says_nothing_of_them() -> None:
    result = message()
    sun = result.lights[0]
    sun.plan.maps.add(index=0, energy=1.5)
    sun.plan.maps.add(index=1, energy=0.5)
    sun.shot.crawl.SetInParent()
    plan = lightfit.FitResult.of(result)["sun"].plan
    assert plan is not None and [part.energy for part in plan.maps] == [1.5, 0.5]
    assert plan.is_new is None and plan.maps[0].action is None
    sun.shot.plan.maps.add(frames_kept=3)
    sun.shot.plan.maps.add(frames_kept=0)
    plan = lightfit.FitResult.of(result)["sun"].plan
    assert plan is not None and [part.frames_kept for part in plan.maps] == [3, 0]


def test_a_light_is_found_by_its_name() -> None:
    with pytest.raises(KeyError, match="rim"):
        lightfit.FitResult.of(message())["rim"]


def test_words_of_a_later_version_are_numbers() -> None:
    later = message()
    later.lights[0].stop_reason = 77  # type: ignore[assignment]
    later.lights[0].shot.action = shot_pb2.TRACKER_ACTION_KEPT  # type: ignore[assignment]
    later.lights[1].status.code = 77
    result = lightfit.FitResult.of(later)
    assert result["sun"].stop_reason == "77"
    assert result["sun"].action == "KEPT"
    assert result["key"].status.code == "77"


def test_an_allocation_knows_the_sizes() -> None:
    allocation = lightfit.Allocation.of(
        allocation_pb2.Allocation(lights=message().lights, texels=2048)
    )
    assert allocation.map_sizes == {"sun": (64, 32), "key": (0, 0)}
    assert allocation.texels == 2048
