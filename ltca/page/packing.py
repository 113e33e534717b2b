"""Arrays of numbers as text that a page opens: float32, gzipped, in base64.

Bytes stand in four planes, all first ones, all second ones: neighbouring positions share the upper two, and a third less is
left to store. Nothing of the clock is in it: the same numbers give the same text.
"""

from __future__ import annotations

import base64
import gzip
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import FloatArray

LEVEL = 6
"""Of gzip: 9 takes twice the time for a hundredth less."""


def pack(arrays: Mapping[str, FloatArray]) -> tuple[dict[str, list[int]], str]:
    """Return where each array lies, number of its first value and shape, and all of them as text.

    The text has all values in this order as float32, bytes in planes, gzipped, in base64; not-a-number values stay so.

    Examples
    --------
    >>> places, text = pack({"load": np.array([[1.0, 2.0], [3.0, 4.0]]), "angle": np.zeros(3)})
    >>> places
    {'load': [0, 2, 2], 'angle': [4, 3]}
    >>> unpack(places, text)["load"].tolist()
    [[1.0, 2.0], [3.0, 4.0]]
    """
    places: dict[str, list[int]] = {}
    first = 0
    for name, values in arrays.items():
        places[name] = [first, *values.shape]
        first += values.size
    every = [np.asarray(values, dtype="<f4").ravel() for values in arrays.values()]
    planes = np.concatenate([np.zeros(0, "<f4"), *every]).view(np.uint8).reshape(-1, 4).T
    return places, base64.b64encode(gzip.compress(planes.tobytes(), LEVEL, mtime=0)).decode("ascii")


def unpack(places: Mapping[str, list[int]], text: str) -> dict[str, NDArray[np.float32]]:
    """Return the arrays of `pack`, as a page reads them."""
    planes = np.frombuffer(gzip.decompress(base64.b64decode(text)), np.uint8).reshape(4, -1)
    values = np.ascontiguousarray(planes.T).view("<f4").ravel()
    return {
        name: values[first : first + int(np.prod(shape))].reshape(shape) for name, (first, *shape) in places.items()
    }
