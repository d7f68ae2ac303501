"""What can go wrong with a call, one exception per kind."""

from __future__ import annotations

import enum
from typing import Dict, Optional, Type


class Code(enum.IntEnum):
    """The canonical codes, numbered as google.rpc.Code."""

    OK = 0
    CANCELLED = 1
    UNKNOWN = 2
    INVALID_ARGUMENT = 3
    DEADLINE_EXCEEDED = 4
    NOT_FOUND = 5
    ALREADY_EXISTS = 6
    PERMISSION_DENIED = 7
    RESOURCE_EXHAUSTED = 8
    FAILED_PRECONDITION = 9
    ABORTED = 10
    OUT_OF_RANGE = 11
    UNIMPLEMENTED = 12
    INTERNAL = 13
    UNAVAILABLE = 14
    DATA_LOSS = 15
    UNAUTHENTICATED = 16

    @classmethod
    def name_of(cls, number: int) -> str:
        """"NOT_FOUND" for 5; the number itself where this version has no word for it."""
        return cls(number).name if number in cls._value2member_map_ else str(number)


class LightfitWarning(UserWarning):
    """Input that was used as it is and may be a mistake. The text says what to do."""


class LightfitError(Exception):
    """A call that failed as a whole. `str()` is one line that says what is wrong and the way out.

    code: the canonical code, "INVALID_ARGUMENT".
    message: that line without the request_id.
    request_id: names the call in the server's log; None where nothing was sent.
    retry_after_s: seconds after which the server says to try again; None when it says nothing.
    """

    code: str = "UNKNOWN"

    def __init__(
        self, message: str, *, code: Optional[str] = None, request_id: Optional[str] = None
    ) -> None:
        super().__init__(message)
        self.message = message
        if code is not None:
            self.code = code
        self.request_id = request_id
        self.retry_after_s: Optional[float] = None

    def __str__(self) -> str:
        request = f" (request {self.request_id})" if self.request_id else ""
        return f"{self.message}{request}"


class InvalidArgumentError(LightfitError, ValueError):
    """An argument is wrong; the message names it, its value, and what is wanted."""

    code = "INVALID_ARGUMENT"


class FailedPreconditionError(LightfitError):
    """The request is fine and there is nothing to compute."""

    code = "FAILED_PRECONDITION"


class BusyError(LightfitError):
    """The server has no room at the moment; trying again later helps."""

    code = "RESOURCE_EXHAUSTED"


class TooLargeError(LightfitError):
    """The request is larger than the server takes; trying again does not help."""

    code = "RESOURCE_EXHAUSTED"


class UnavailableError(LightfitError):
    """No server answers, or it is about to go."""

    code = "UNAVAILABLE"


class DeadlineError(LightfitError, TimeoutError):
    """The call did not end within timeout_s."""

    code = "DEADLINE_EXCEEDED"


class CancelledError(LightfitError):
    """The call was stopped."""

    code = "CANCELLED"


_KINDS: Dict[str, Type[LightfitError]] = {
    kind.code: kind
    for kind in (
        InvalidArgumentError,
        FailedPreconditionError,
        TooLargeError,
        UnavailableError,
        DeadlineError,
        CancelledError,
    )
}


def error_of(code: int, message: str, request_id: Optional[str] = None) -> LightfitError:
    """The exception for a canonical code that is not OK."""
    name = Code.name_of(code)
    return _KINDS.get(name, LightfitError)(message, code=name, request_id=request_id)
