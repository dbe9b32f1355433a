"""How numbers, names and comments are written in C99, in double or in single precision."""

from __future__ import annotations

import math
import re
import unicodedata
from dataclasses import dataclass

import numpy as np

from fotsmc_pin.export.values import BOOL, INT, LONG, REAL

KEYWORDS = frozenset(
    [
        "auto",
        "break",
        "case",
        "char",
        "const",
        "continue",
        "default",
        "do",
        "double",
        "else",
        "enum",
        "extern",
        "float",
        "for",
        "goto",
        "if",
        "inline",
        "int",
        "long",
        "register",
        "restrict",
        "return",
        "short",
        "signed",
        "sizeof",
        "static",
        "struct",
        "switch",
        "typedef",
        "union",
        "unsigned",
        "void",
        "volatile",
        "while",
        "bool",
        "true",
        "false",
        "asm",
        "class",
        "new",
        "delete",
        "this",
        "template",
        "catch",
        "explicit",
        "export",
        "friend",
        "mutable",
        "namespace",
        "operator",
        "private",
        "protected",
        "public",
        "throw",
        "try",
        "typename",
        "using",
        "virtual",
        "and",
        "or",
        "not",
        "xor",
    ]
)
"""Words that no name in C may be, nor in C++, which reads the header."""

FUNCTIONS = frozenset(
    [
        "acos",
        "acosh",
        "asin",
        "asinh",
        "atan",
        "atan2",
        "atanh",
        "cbrt",
        "ceil",
        "copysign",
        "cos",
        "cosh",
        "div",
        "erf",
        "erfc",
        "exp",
        "exp2",
        "expm1",
        "fabs",
        "fdim",
        "floor",
        "fma",
        "fmax",
        "fmin",
        "fmod",
        "frexp",
        "gamma",
        "hypot",
        "ilogb",
        "j0",
        "j1",
        "jn",
        "ldexp",
        "lgamma",
        "llrint",
        "llround",
        "log",
        "log10",
        "log1p",
        "log2",
        "logb",
        "lrint",
        "lround",
        "modf",
        "nan",
        "nearbyint",
        "nextafter",
        "pow",
        "remainder",
        "remquo",
        "rint",
        "round",
        "scalbn",
        "signbit",
        "sin",
        "sinh",
        "sqrt",
        "tan",
        "tanh",
        "tgamma",
        "trunc",
        "y0",
        "y1",
        "yn",
        "isfinite",
        "isinf",
        "isnan",
        "abs",
        "labs",
        "main",
        "index",
    ]
)
"""Functions that are there already."""

OWN = frozenset(["square", "cube", "least", "greatest", "floored", "remaining", "whole"])
"""Short functions that a program brings (`program.HELPERS`)."""

MATH = {
    **dict.fromkeys(
        [
            "exp",
            "sqrt",
            "copysign",
            "tanh",
            "hypot",
            "log",
            "sin",
            "cos",
            "tan",
            "atan",
            "atan2",
            "asin",
            "acos",
            "sinh",
            "cosh",
            "asinh",
            "acosh",
            "atanh",
            "expm1",
            "log1p",
            "log2",
            "log10",
            "erf",
            "erfc",
            "lgamma",
            "fmod",
            "pow",
            "fma",
            "cbrt",
            "exp2",
        ]
    ),
    "gamma": "tgamma",
    "fabs": "fabs",
}
"""Functions of Python's `math` that C has too; under another name where one is given."""


@dataclass(frozen=True)
class Dialect:
    """Double or single precision.

    Attributes:
        single: whether reals are `float`.
    """

    single: bool = False

    @property
    def real(self) -> str:
        """The type of reals."""
        return "float" if self.single else "double"

    def type_of(self, kind: str) -> str:
        """Return the C type of a kind of numbers."""
        return {REAL: self.real, INT: "int", LONG: "long long", BOOL: "bool"}[kind]

    def function(self, name: str) -> str:
        """Return the name of a function of `math.h` for this precision."""
        return name + "f" if self.single else name

    def number(self, value: float) -> str:
        """Return a real as a literal that reads back as the same number.

        In single precision a number too small becomes the least one that keeps its digits.
        """
        if math.isnan(value):
            return "NAN"
        if math.isinf(value):
            return "INFINITY" if value > 0.0 else "-INFINITY"
        if not self.single:
            return repr(float(value))
        limits = np.finfo(np.float32)
        magnitude = min(abs(value), float(limits.max))
        if magnitude != 0.0:
            magnitude = max(magnitude, float(limits.tiny))
        text = str(np.float32(magnitude))
        text = text if any(mark in text for mark in ".e") else text + ".0"
        return ("-" if math.copysign(1.0, value) < 0.0 else "") + text + "f"


def member_name(name: str) -> str:
    """Return the name of a member of a struct: Greek letters by their names, no keyword."""
    letters = [letter if letter.isascii() else _spelled(letter) for letter in name]
    plain = "".join(letters).strip("_") or "unnamed"
    plain = plain if not plain[0].isdigit() else f"n{plain}"
    return f"{plain}_" if plain in KEYWORDS else plain


def identifier(name: str) -> str:
    """Return the name of a function or a variable, different from all that are there already."""
    plain = member_name(name)
    return f"{plain}_" if plain in FUNCTIONS | OWN or re.search(r"_v\d+$", plain) else plain


def _spelled(letter: str) -> str:
    words = unicodedata.name(letter, "").split()
    if words[:1] == ["GREEK"]:
        return words[-1].lower() if "SMALL" in words else words[-1].capitalize()
    return f"u{ord(letter):04x}"


def file_identifier(name: str) -> str:
    """Return the name of an arm as part of a C name."""
    return re.sub(r"\W+", "_", name, flags=re.ASCII).strip("_") or "arm"


def comment(text: str, indent: str = "") -> list[str]:
    """Return text as a C comment, one line or a block."""
    safe = text.replace("*/", "* /").replace("/*", "/ *").replace("??", "? ?")
    lines = [line.rstrip() for line in safe.strip().splitlines()] or [""]
    if len(lines) == 1:
        return [f"{indent}/* {lines[0]} */"]
    body = [f"{indent} * {line}".rstrip() for line in lines[1:]]
    return [f"{indent}/* {lines[0]}", *body, f"{indent} */"]
