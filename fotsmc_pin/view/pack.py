"""Arrays packed into one compressed text that a page can hold."""

from __future__ import annotations

import base64
import zlib
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

ArrayPlace: TypeAlias = dict[str, int | str]

WORDS = {"f4": np.int32, "u4": np.int32, "u2": np.int16}


LEVEL = 6
"""Of deflate: level 9 takes twice as long and makes a page a hundredth smaller."""


class Pack:
    """Collects arrays and tells the place of each, by which the page finds it again.

    An array is stored as the differences of its neighbouring words, folded so that small ones have
    small words, with the bytes of equal weight together: smooth columns then deflate well, and not
    a bit is lost. The page's `data.js` undoes it. Equal arrays are stored once.
    """

    def __init__(self) -> None:
        """Start empty."""
        self._chunks: list[bytes] = []
        self._places: dict[tuple[str, bytes], ArrayPlace] = {}
        self._size = 0

    def add(self, array: ArrayLike, kind: str = "f4") -> ArrayPlace:
        """Store an array, flattened in C order, and return its place.

        Args:
            array: numbers, best with the axis along which they are smooth last.
            kind: "f4" (float32), "u4" or "u2" (unsigned words of 4 or 2 bytes).
        """
        flat = np.ascontiguousarray(array, dtype=np.dtype(kind).newbyteorder("<")).ravel()
        key = (kind, flat.tobytes())
        if key not in self._places:
            encoded = _encoded(flat.view(WORDS[kind]))
            self._places[key] = {"at": self._size, "count": len(flat), "kind": kind}
            self._chunks.append(encoded)
            self._size += len(encoded)
        return self._places[key]

    def text(self) -> str:
        """Return everything stored, deflated, in base64."""
        return base64.b64encode(zlib.compress(b"".join(self._chunks), LEVEL)).decode("ascii")


def _encoded(words: np.ndarray) -> bytes:
    bits = 8 * words.itemsize
    steps = np.diff(words, prepend=words.dtype.type(0))
    folded = (steps << 1) ^ (steps >> (bits - 1))
    return folded.view(np.uint8).reshape(-1, words.itemsize).T.tobytes()
