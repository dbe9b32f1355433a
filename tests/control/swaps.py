"""Exchanges any two fields of any law and reports who notices: `python -m tests.control.swaps`.

Twice over. In the declaration, where the tests of order (`test_declaration`, `test_gains`) must
fail: the source is exchanged and compiled anew. And in a running controller, where the kernel then
reads one row for the other and must part from the law's equations as `test_equations` writes them;
this is asked of all rows that a kernel reads, with gains that all differ. Two rows of which the
law is a symmetric function are exchanged unnoticed, and rightly so.
"""

from __future__ import annotations

import inspect
import re
import sys
import warnings
from dataclasses import fields
from itertools import combinations

import numpy as np

from fotsmc_pin.arms import load_arm
from fotsmc_pin.control import CONTROLLERS
from fotsmc_pin.control.gains import Gains
from fotsmc_pin.control.rows import Joints, row_names
from tests.control.conftest import wandering
from tests.control.test_declaration import described
from tests.control.test_equations import LAWS, Tick

TICKS = 40
PARTS = "fotsmc_pin.control.fractional_surface", "fotsmc_pin.control.adaptation"
INERT = {"alpha", "tempering", "start", "memory_horizon"}
"""Gains that make the streams; no kernel reads their rows."""


def declared_swaps(law):
    """Yield each pair of a law's declared fields, and whether the tests of order notice."""
    for cls in {*law.Gains.__mro__, law.State}:
        own = [*inspect.get_annotations(cls)]
        if cls is Gains or len(own) < 2 or cls.__module__ == "builtins":
            continue
        source = inspect.getsource(inspect.getmodule(cls))
        for one, other in combinations(own, 2):
            swapped = exchanged(source, cls.__name__, one, other)
            scope = {"__name__": f"swapped_{cls.__name__}"}
            sys.modules[scope["__name__"]] = inspect.getmodule(cls)
            exec(compile(swapped, "<swapped>", "exec"), scope)
            order = [*scope[cls.__name__].__annotations__]
            assert order != own
            yield f"{cls.__name__}: {one}, {other}", described(scope[cls.__name__]) != order


def exchanged(source, cls, one, other):
    """Exchange the lines on which a class declares two of its fields."""
    start = source.index(f"\nclass {cls}(")
    head, body = source[:start], source[start:]
    lines = [re.search(rf"^    {name}: .*$", body, re.MULTILINE).group() for name in (one, other)]
    body = body.replace(lines[0], "\0", 1).replace(lines[1], lines[0], 1)
    return head + body.replace("\0", lines[1], 1)


def running_swaps(law, preset, written, arm):
    """Yield each pair of rows that the kernel reads, and whether the equations notice."""
    gains = distinct_gains(law, preset, arm)
    modules = [inspect.getmodule(law), *(sys.modules[name] for name in PARTS)]
    source = "\n".join(inspect.getsource(module) for module in modules)
    names = [*Joints._fields, *row_names(law.Gains)._fields, *law.State._fields]
    for group, prefix in ((row_names(law.Gains)._fields, "g"), (law.State._fields, "m")):
        read = [n for n in group if n not in INERT and re.search(rf"\b{prefix}\.{n}\b", source)]
        for one, other in combinations(read, 2):
            controller = law(arm, 1e-3, preset=preset, **gains)
            controller.joints.effort_limit[:] = np.inf
            rows = [names.index(one), names.index(other)]
            if prefix == "g":
                swap(controller, rows)
            expected, far, scale = written(controller.gains, arm.nv), 0.0, 1.0
            for k, row in enumerate(wandering(arm, TICKS)):
                if prefix == "m" and k == TICKS // 2:
                    swap(controller, rows)
                wanted = expected(Tick(arm, row))
                scale = max(scale, np.abs(wanted).max())
                with np.errstate(all="ignore"):
                    error = np.abs(controller.update(*row) - wanted).max()
                far = max(far, error if np.isfinite(error) else np.inf)
            yield f"{law.__name__}: {one}, {other}", far > 1e-8 * scale


def swap(controller, rows):
    """Exchange two rows of a controller's table."""
    controller._table[rows] = controller._table[rows[::-1]]


def distinct_gains(law, preset, arm):
    """Return the preset's numbers, each moved by some percent of its own."""
    start = law(arm, 1e-3, preset=preset).gains
    moved = {}
    for k, field in enumerate(fields(start)):
        value = getattr(start, field.name)
        if field.metadata["kind"] in ("scalar", "per joint") and field.name not in INERT:
            moved[field.name] = value * (0.97 - 0.01 * k)
    return moved


def main():
    """Print every exchange that nobody notices, and count the rest.

    A row that one preset does not use another one does: an exchange counts once for each law.
    """
    warnings.simplefilter("ignore")
    arm = load_arm("two_link")
    declared = dict(swap for law in CONTROLLERS.values() for swap in declared_swaps(law))
    running = {}
    for law, preset, text in LAWS:
        for name, noticed in running_swaps(law, preset, text, arm):
            running[name] = running.get(name, False) or noticed
    for where, found in (("declaration", declared), ("running law", running)):
        missed = [name for name, noticed in found.items() if not noticed]
        print(f"{where}: {len(found)} exchanges, not noticed: {'; '.join(missed) or 'none'}")
    return not all(declared.values())


if __name__ == "__main__":
    sys.exit(main())
