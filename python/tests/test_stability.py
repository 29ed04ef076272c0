"""Published names of the package are still there, as `docs/command-line.md` promises.

``WILDFIRE_REWRITE_DATA=1 pytest tests/test_stability.py`` adds the names of today to `names.txt`.
"""

from __future__ import annotations

import inspect
import os
import pathlib

import wildfire_contest as wf
from wildfire_contest import errors, policies

PUBLISHED = pathlib.Path(__file__).parent / "names.txt"


def names(thing: object, path: str) -> set[str]:
    """Return a name, those of its parameters, and of a class those of its members."""
    found = {path}
    if inspect.isroutine(thing):
        found |= {f"{path}({name})" for name in inspect.signature(thing).parameters if name != "self"}
    if isinstance(thing, type):
        members = [name for name in vars(thing) if not name.startswith("_")]
        found = found.union(*(names(inspect.getattr_static(thing, name), f"{path}.{name}") for name in members))
    return found


def test_no_published_name_is_gone() -> None:
    today = set().union(*(names(getattr(wf, name), name) for name in wf.__all__))
    for module in (errors, policies):
        short = module.__name__.rpartition(".")[2]
        own = [name for name, thing in vars(module).items() if getattr(thing, "__module__", "") == module.__name__]
        today = today.union(*(names(getattr(module, name), f"{short}.{name}") for name in own if not name.startswith("_")))
    published = set(PUBLISHED.read_text().splitlines())
    assert published - today == set()
    assert len(published) > 100
    if os.environ.get("WILDFIRE_REWRITE_DATA") == "1":
        PUBLISHED.write_text("".join(f"{name}\n" for name in sorted(today)))
