"""The client against the real server: the answers of this process, bit for bit."""

import pathlib
import threading
from typing import Any, List

import numpy
import pytest

import lightfit
from conftest import ROOM, YARD
from readbacks import large_readback
from serving import Server, make_certificates

MAP = (1024, 1024)


@pytest.fixture
def arguments(yard: lightfit.ExrReadback) -> Any:
    return yard.depth, yard.shadow, yard.camera, yard.lights


@pytest.mark.parametrize("clip", ["vulkan", "direct3d", "opengl", "reversed_z", "metal-reversed"])
def test_a_fit_is_that_of_this_process(client: Any, arguments: Any, clip: str) -> None:
    want = lightfit.fit(*arguments, MAP, clip=clip, foretell_wrong=True, source="yard")
    result = client.fit(*arguments, MAP, clip=clip, foretell_wrong=True, source="yard")
    assert result.message == want.message
    for light, other in zip(result.lights, want.lights):
        assert numpy.array_equal(light.clip_from_world, other.clip_from_world)


def test_formats_of_pixels_give_the_same(client: Any, arguments: Any) -> None:
    depth, shadow, camera, lights = arguments
    planes = numpy.stack([(shadow >> light) & 1 for light in range(3)]).astype(bool)
    with numpy.errstate(over="ignore"):
        halves = depth.astype(numpy.float16)
    for pixels in ((depth, planes), (halves, shadow), (halves, planes)):
        want = lightfit.fit(*pixels, camera, lights, MAP)
        assert client.fit(*pixels, camera, lights, MAP).message == want.message


def test_facing_travels_in_every_form(client: Any, cast: lightfit.ExrReadback) -> None:
    first = (cast.depth, cast.shadow, cast.camera, cast.lights)
    assert cast.facing is not None
    low, lamp = (numpy.asarray(plane) for plane in cast.facing)
    bits = low.astype(numpy.uint32) | lamp.astype(numpy.uint32) << numpy.uint32(1)
    options = {"border": "auto"}
    forms = (bits, numpy.stack([low, lamp]), [low, lamp.astype(numpy.uint8) * 255])
    want = lightfit.fit(*first, MAP, options=options, facing=cast.facing)
    for facing in forms:
        for calls in (lightfit, client):
            result = calls.fit(*first, MAP, options=options, facing=facing)
            assert result.message == want.message
    partly = {"facing": [None, lamp], "mapped": [low, None]}
    want = lightfit.fit(*first, MAP, options=options, **partly)
    assert client.fit(*first, MAP, options=options, **partly).message == want.message
    candidates = [
        lightfit.Candidate.map(light.name, light.map_from_world, MAP)
        for light in want.lights
        if light.map_from_world is not None
    ]
    evaluated = lightfit.evaluate(*first, candidates, **partly)
    assert client.evaluate(*first, candidates, **partly).message == evaluated.message
    sizes = lightfit.allocate(*first, budget_texels=1 << 20, **partly)
    assert client.allocate(*first, budget_texels=1 << 20, **partly).message == sizes.message


@pytest.mark.parametrize("example", [YARD, ROOM])
def test_files_are_fitted_as_in_this_process(client: Any, example: pathlib.Path) -> None:
    exr, lights = example / "0001.exr", example / "scene.json"
    want = lightfit.fit_exr(exr, lights, MAP)
    assert client.fit_exr(exr, lights, MAP).message == want.message


@pytest.mark.parametrize("has_planes", [False, True])
def test_large_readbacks_are_streamed(client: Any, has_planes: bool) -> None:
    depth, shadow, camera, lights = large_readback(1500, 1001)  # 12 MB
    if has_planes:
        shadow = numpy.stack([(shadow >> light) & 1 for light in range(3)]).astype(bool)
    want = lightfit.fit(depth, shadow, camera, lights, MAP)
    assert want.ok
    assert client.fit(depth, shadow, camera, lights, MAP).message == want.message
    facing = [depth < 19, None, depth < 18]
    with lightfit.track(MAP) as here, client.track(MAP) as there:
        expected = here.update(1, depth, shadow, camera, lights, facing=facing)
        answer = there.update(1, depth, shadow, camera, lights, facing=facing)
        assert answer.message == expected.message


def test_a_light_that_cannot_be_used_fails_alone(client: Any, arguments: Any) -> None:
    lights = [*arguments[3], lightfit.Light.sun("dark", (0, 0, 0))]
    want = lightfit.fit(*arguments[:3], lights, MAP)
    result = client.fit(*arguments[:3], lights, MAP)
    assert not result["dark"].ok and result["sun"].ok
    assert result.message == want.message


def test_errors_are_those_of_this_process(client: Any, arguments: Any) -> None:
    twice = [arguments[3][0]] * 2
    with pytest.raises(lightfit.InvalidArgumentError) as want:
        lightfit.fit(*arguments[:3], twice, MAP)
    with pytest.raises(lightfit.InvalidArgumentError) as caught:
        client.fit(*arguments[:3], twice, MAP, request_id="twice 1")
    assert caught.value.message == want.value.message
    assert caught.value.request_id == "twice 1" and "twice 1" in str(caught.value)


def test_the_log_names_the_request(client: Any, server: Server, arguments: Any) -> None:
    client.fit(*arguments, MAP, request_id="named-by-the-test")
    deadline = threading.Event()
    for _ in range(100):
        if any("named-by-the-test" in line for line in server.log):
            return
        deadline.wait(0.05)
    raise AssertionError("".join(server.log[-20:]))


def test_evaluations_and_allocations_are_those_of_this_process(
    client: Any, arguments: Any
) -> None:
    candidates = [
        lightfit.Candidate.map(light.name, light.map_from_world, MAP)
        for light in lightfit.fit(*arguments, MAP).lights
        if light.map_from_world is not None
    ]
    want = lightfit.evaluate(*arguments, candidates)
    assert client.evaluate(*arguments, candidates).message == want.message
    sizes = lightfit.allocate(*arguments, budget_texels=1 << 20, weights={"sun": 2.0})
    result = client.allocate(*arguments, budget_texels=1 << 20, weights={"sun": 2.0})
    assert result.message == sizes.message
    tolerance = lightfit.Tolerance(2.0, 4.0)
    assert (
        client.allocate(*arguments, tolerance=tolerance).message
        == lightfit.allocate(*arguments, tolerance=tolerance).message
    )


def test_summaries_are_fitted_as_in_this_process(
    client: Any, tmp_path: pathlib.Path, run_lightfit: Any
) -> None:
    summary = tmp_path / "shot.summary"
    run_lightfit(
        "summarize", YARD / "0001.exr", "--lights", YARD / "scene.json", "--output", summary
    )
    want = lightfit.fit_summary([summary], MAP)
    assert want.ok
    assert client.fit_summary([summary], MAP).message == want.message


def test_a_track_is_that_of_this_process(client: Any, arguments: Any) -> None:
    with lightfit.track(MAP, stability=0.5) as here, client.track(MAP, stability=0.5) as there:
        for number in range(6):
            shadow = numpy.roll(arguments[1], number, axis=1)
            frame = (arguments[0], shadow, *arguments[2:])
            want = here.update(number, *frame)
            result = there.update(number, *frame)
            assert result.message == want.message
        with pytest.raises(lightfit.InvalidArgumentError):
            there.update(7, *arguments[:3], [arguments[3][0]] * 2)
        assert there.update(8, *arguments).message == here.update(8, *arguments).message


def test_a_time_limit_stops_the_search(client: Any, arguments: Any) -> None:
    with pytest.raises(lightfit.DeadlineError):
        client.fit(*arguments, MAP, timeout_s=1e-4)
    assert client.fit(*arguments, MAP).ok


def test_many_threads_share_a_client(client: Any, arguments: Any) -> None:
    want = lightfit.fit(*arguments, MAP).message
    results: List[Any] = []
    threads = [
        threading.Thread(target=lambda: results.append(client.fit(*arguments, MAP).message))
        for _ in range(16)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(results) == 16 and all(result == want for result in results)


def test_a_server_that_starts_again_is_found_again(has_serve: None, arguments: Any) -> None:
    want = lightfit.fit(*arguments, MAP).message
    first = Server()
    with lightfit.Client(first.address) as client, client.track(MAP) as track:
        assert client.health() == "SERVING"
        assert client.fit(*arguments, MAP).message == want
        before = track.update(1, *arguments)
        first.kill()
        second = Server(listen=first.address)
        try:
            assert client.fit(*arguments, MAP).message == want
            after = track.update(2, *arguments)
            assert [light.action for light in after.lights] == ["KEPT"] * 3
            for light, other in zip(before.lights, after.lights):
                assert light.map_from_world is not None and other.map_from_world is not None
                assert numpy.array_equal(light.map_from_world[:2], other.map_from_world[:2])
        finally:
            second.stop()


def test_another_server_takes_over(has_serve: None, arguments: Any) -> None:
    want = lightfit.fit(*arguments, MAP).message
    first, second = Server(), Server()
    try:
        with lightfit.Client(f"{first.address},{second.address}") as client:
            for number in range(12):
                assert client.fit(*arguments, MAP).message == want
                if number == 4:
                    assert first.stop() == 0
    finally:
        first.kill()
        assert second.stop() == 0


def test_a_server_may_be_a_file(has_serve: None, arguments: Any, tmp_path: pathlib.Path) -> None:
    server = Server(listen=f"unix:{tmp_path}/socket")
    try:
        with lightfit.Client(f"unix:{tmp_path}/socket") as client:
            assert client.health() == "SERVING"
            assert client.fit(*arguments, MAP).message == lightfit.fit(*arguments, MAP).message
    finally:
        assert server.stop() == 0


def test_both_sides_may_show_certificates(
    has_serve: None, arguments: Any, tmp_path: pathlib.Path
) -> None:
    studio, other = make_certificates(tmp_path / "a"), make_certificates(tmp_path / "b")
    server = Server(
        *("--tls-certificate", studio / "server.pem", "--tls-key", studio / "server.key"),
        *("--tls-client-ca", studio / "ca.pem"),
    )
    mine = {"cert": studio / "client.pem", "key": studio / "client.key"}
    try:
        tls = lightfit.TlsOptions(ca=studio / "ca.pem", server_name="lightfit.test", **mine)
        with lightfit.Client(server.address, tls=tls) as client:
            assert client.fit(*arguments, MAP).message == lightfit.fit(*arguments, MAP).message
        authority, own = studio / "ca.pem", {"server_name": "lightfit.test"}
        for refused, way_out in (
            (lightfit.TlsOptions(ca=other / "ca.pem", **own, **mine), "want tls: ca="),
            (lightfit.TlsOptions(ca=authority, server_name="other.test", **mine), "server_name="),
            (lightfit.TlsOptions(ca=authority, **own), "tls: cert= and key="),
            (None, "tls=lightfit.TlsOptions"),
        ):
            with lightfit.Client(server.address, tls=refused, retries=0) as client:
                with pytest.raises(lightfit.UnavailableError, match=way_out):
                    client.fit(*arguments, MAP, timeout_s=20)
    finally:
        assert server.stop() == 0
