"""Fingerprints of code, so that a batch notices that a planner has changed."""

from __future__ import annotations

import functools
import hashlib
import sys
import sysconfig
import types
from collections.abc import Iterable
from typing import Any

import numpy as np

from wildfire_contest.policies import Policy

_LIBRARIES = tuple({path for name, path in sysconfig.get_paths().items() if name.endswith(("lib", "stdlib"))})
_MADE_BY_PYTHON = 1 << 9  # Py_TPFLAGS_HEAPTYPE
_NO_CODE = ("__doc__", "__firstlineno__", "__module__", "__orig_bases__")


def fingerprint(thing: object) -> str:
    """Return a short hash of the code of a planner or a policy.

    It covers classes, functions and everything that they name: functions, classes, numbers, strings, tuples and arrays.
        Code of installed packages counts by its name only, and so do objects that may change at run time, such as lists.
    """
    digest, seen = hashlib.sha256(f"{sys.version_info[:2]}".encode()), {}

    def feed(thing: Any) -> None:
        if isinstance(thing, (bool, int, float, complex, str, bytes, type(None))):
            digest.update(repr(thing).encode())
        elif id(thing) not in seen:
            # Keeping a reference ensures that no other object gets the same id.
            seen[id(thing)] = thing
            digest.update(f"<{type(thing).__qualname__} {getattr(thing, '__qualname__', '')}>".encode())
            for part in _parts(thing):
                feed(part)

    feed(thing)
    return digest.hexdigest()[:16]


def _parts(thing: Any) -> Iterable[Any]:
    """Return the parts that determine what a thing does."""
    if isinstance(thing, (tuple, frozenset)):
        return thing if isinstance(thing, tuple) else sorted(thing, key=repr)
    if isinstance(thing, np.ndarray):
        return str(thing.dtype), thing.shape, thing.tobytes() if thing.dtype != object else None
    if isinstance(thing, types.CodeType):
        return thing.co_code, thing.co_names, thing.co_varnames, thing.co_consts
    if isinstance(thing, types.CellType):
        return () if thing == types.CellType() else (thing.cell_contents,)
    if isinstance(thing, types.FunctionType):
        is_own = not thing.__code__.co_filename.startswith(_LIBRARIES)
        named = _named(thing.__code__, thing.__globals__) if is_own else []
        return (thing.__code__, thing.__defaults__, *_members(thing.__kwdefaults__), *(thing.__closure__ or ()), *named)
    if isinstance(thing, type):
        is_own = bool(thing.__flags__ & _MADE_BY_PYTHON) and not _is_library(thing.__module__)
        return (*thing.__bases__, *_members(vars(thing))) if is_own else ()
    if isinstance(thing, functools.partial):
        return thing.func, thing.args, *_members(thing.keywords)
    if isinstance(thing, (types.MethodType, staticmethod, classmethod)):
        return thing.__func__, getattr(thing, "__self__", None)
    if isinstance(thing, property):
        return thing.fget, thing.fset
    return (type(thing), *_members(getattr(thing, "__dict__", None))) if callable(thing) or isinstance(thing, Policy) else ()


def _members(parts: Any) -> list[Any]:
    return [half for name in sorted(parts or ()) if name not in _NO_CODE for half in (name, parts[name])]


def _named(code: types.CodeType, scope: dict[str, Any]) -> list[Any]:
    """Return the objects that code names in its own module and in modules that are not installed packages."""
    named = [scope[name] for name in code.co_names if name in scope]
    modules = [vars(it) for it in named if isinstance(it, types.ModuleType) and not _is_library(it.__name__)]
    named += [module[name] for module in modules for name in code.co_names if name in module]
    return named + [it for inner in code.co_consts if isinstance(inner, types.CodeType) for it in _named(inner, scope)]


def _is_library(module: str) -> bool:
    file = getattr(sys.modules.get(module), "__file__", None) or ""
    return module.startswith("wildfire_contest") or (module != "__main__" and file.startswith(_LIBRARIES))
