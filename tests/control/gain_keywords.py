"""Writes control/gain_keywords.py from the laws' `Gains`: `python -m tests.control.gain_keywords`.

A type checker and an editor must see the names of a law's gains in the law's signature, and cannot
read them off a dataclass. So they are written out, and a test holds the file to the dataclasses.
"""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path

import fotsmc_pin
from fotsmc_pin.control import CONTROLLERS
from fotsmc_pin.control.gains import DERIVED

FILE = Path(fotsmc_pin.__file__).parent / "control/gain_keywords.py"
HEAD = '''"""The gains of every law as keywords, for type checkers and editors.

Written by `python -m tests.control.gain_keywords` from the laws' `Gains`; do not edit it.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, TypeAlias, TypedDict

from fotsmc_pin.types import Array

PerJoint: TypeAlias = float | Sequence[float] | Array
"""One number for all joints, or one for each."""
'''


def written() -> str:
    """Return what the file has to say."""
    return HEAD + "".join(
        keywords(law) for law in sorted(CONTROLLERS.values(), key=lambda law: law.__name__)
    )


def keywords(law: type) -> str:
    lines = "".join(f"    {field.name}: {annotation(field)}\n" for field in fields(law.Gains))
    return (
        f"\n\nclass {law.__name__}Keywords(TypedDict, total=False):\n"
        f'    """Gains of `{law.__name__}`."""\n\n{lines}'
    )


def annotation(field) -> str:
    match field.metadata["kind"]:
        case "scalar":
            return "float"
        case "per joint":
            return "PerJoint | None" if field.default is DERIVED else "PerJoint"
        case "option":
            choices = ", ".join(f'"{choice}"' for choice in field.metadata["choices"])
            return f"Literal[{choices}]"
        case _:
            return "bool"


if __name__ == "__main__":
    FILE.write_text(written(), "utf-8")
