"""Array types, by their elements; shapes stand in docstrings, as numpy cannot check them."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
"""Real numbers."""

ComplexArray = NDArray[np.complex128]
"""Complex numbers: modes, and derivatives by a complex step."""

BoolArray = NDArray[np.bool_]
"""Masks."""

IntArray = NDArray[np.intp]
"""Indices and counts."""

StampArray = NDArray[np.int64]
"""Stamps, integer nanoseconds."""

ByteArray = NDArray[np.uint8]
"""Bytes: images of the trawl sonar, and what messages hold."""

if TYPE_CHECKING:
    Slice = slice[int, int, None]
else:
    Slice = slice
"""Contiguous part of an array; builtin slices take no types when they run."""
