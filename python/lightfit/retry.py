"""When a call that failed is tried again."""

from __future__ import annotations

import dataclasses
import random
import time
from typing import Callable, Optional, TypeVar

from lightfit.errors import BusyError, LightfitError, UnavailableError

Answer = TypeVar("Answer")


@dataclasses.dataclass(frozen=True)
class RetryPolicy:
    """Calls that were refused (BusyError) or got no answer (UnavailableError) are tried again, after
    a wait that doubles each time and is shortened at random by up to a half, so that clients do not
    come back together. Where the server says how long to wait, it is at least that long. All of
    lightfit's calls may be repeated: they change nothing."""

    retries: int = 6  # after the first attempt
    first_wait_s: float = 0.1
    longest_wait_s: float = 3.0

    def wait_s(self, num_failed: int, error: LightfitError) -> Optional[float]:
        """Before the next attempt; None: there is none. num_failed: attempts so far, >= 1."""
        if num_failed > self.retries or not isinstance(error, (BusyError, UnavailableError)):
            return None
        wait = min(self.longest_wait_s, self.first_wait_s * 2.0 ** (num_failed - 1))
        wait *= random.uniform(0.5, 1.0)
        if error.retry_after_s is not None:
            if error.retry_after_s < 0.0:
                return None
            wait += error.retry_after_s
        return wait


def call_with_retries(
    attempt: Callable[[Optional[float]], Answer],
    policy: RetryPolicy,
    timeout_s: Optional[float],
    sleep: Callable[[float], None] = time.sleep,
) -> Answer:
    """attempt: makes the call within the seconds it is given, None for no limit. Attempts and waits
    together keep timeout_s: the last error is raised when there is no time left for another."""
    end = None if timeout_s is None else time.monotonic() + timeout_s
    num_failed = 0
    while True:
        try:
            return attempt(None if end is None else max(0.0, end - time.monotonic()))
        except LightfitError as error:
            num_failed += 1
            wait = policy.wait_s(num_failed, error)
            if wait is None or (end is not None and time.monotonic() + wait >= end):
                raise
        sleep(wait)
