"""Exceptions: their kinds, codes and words."""

import pytest

import lightfit
from lightfit.errors import error_of


@pytest.mark.parametrize(
    "code, kind, builtin",
    [
        (1, lightfit.CancelledError, Exception),
        (3, lightfit.InvalidArgumentError, ValueError),
        (4, lightfit.DeadlineError, TimeoutError),
        (8, lightfit.TooLargeError, Exception),
        (9, lightfit.FailedPreconditionError, Exception),
        (14, lightfit.UnavailableError, Exception),
        (13, lightfit.LightfitError, Exception),
        (99, lightfit.LightfitError, Exception),
    ],
)
def test_every_code_has_its_exception(code: int, kind: type, builtin: type) -> None:
    error = error_of(code, "map: is 0 x 0", "r1")
    assert type(error) is kind
    assert isinstance(error, builtin) and isinstance(error, lightfit.LightfitError)
    assert error.code == lightfit.Code.name_of(code)
    assert error.message == "map: is 0 x 0"
    assert str(error) == "map: is 0 x 0 (request r1)"


def test_an_error_that_was_not_sent_has_no_request() -> None:
    error = error_of(3, "map: is 0 x 0")
    assert error.request_id is None
    assert str(error) == "map: is 0 x 0"


def test_codes_have_the_numbers_of_grpc() -> None:
    grpc = pytest.importorskip("grpc")
    assert {code.name: code.value for code in lightfit.Code} == {
        code.name: code.value[0] for code in grpc.StatusCode
    }
