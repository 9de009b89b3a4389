# SPDX-License-Identifier: MIT
"""What is said of calls with a wrong number of arguments."""
from __future__ import annotations

import functools
import inspect
import typing

Owner = typing.TypeVar("Owner", bound=type)


def _as_python_would(take: typing.Any, function: typing.Any) -> typing.Any:
    @functools.wraps(function)
    def call(*given: typing.Any, **named: typing.Any) -> typing.Any:
        take(*given, **named)
        return function(*given, **named)
    call.__qualname__ = take.__qualname__
    call.__signature__ = inspect.signature(take)  # type: ignore[attr-defined]
    return call


def told_in_a_sentence(owner: Owner) -> Owner:
    """Has Python itself tell what is missing, too much, or of a name that is none, of all that the class can be asked.

    pybind11 writes down all that could be given and all that was, arrays too, and asks nobody for other words. What is
    taken stands in the first line of a docstring; `inspect.signature` has it from there.
    """
    for name, method in list(vars(owner).items()):
        function = getattr(owner, name)
        if not callable(function) or (name.startswith("_") and name != "__init__"):
            continue
        scope: dict[str, typing.Any] = {}
        exec(f"def {str(function.__doc__).splitlines()[0]}: pass", scope)
        scope[name].__qualname__ = f"{owner.__name__}.{name}"
        call = _as_python_would(scope[name], function)
        setattr(owner, name, staticmethod(call) if isinstance(method, staticmethod) else call)
    return owner
