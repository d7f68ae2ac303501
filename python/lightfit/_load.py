"""The compiled part, loaded when it is first needed: a client of a server can do without it."""

from __future__ import annotations

import importlib
from typing import Any


def native() -> Any:
    """lightfit._native. Raises ImportError with the way out where there is none."""
    try:
        return importlib.import_module("lightfit._native")
    except ImportError as error:
        raise ImportError(
            f"lightfit: the compiled part cannot be loaded ({error}); build it with cmake --build "
            "BUILD --target lightfit_python for this Python and put BUILD/python on PYTHONPATH. "
            "Only lightfit.Client.fit and other calls to a server do without it"
        ) from error
