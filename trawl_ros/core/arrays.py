# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Array types by element; shapes are given in docstrings, because NumPy cannot check them."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
"""Real numbers."""

BoolArray = NDArray[np.bool_]
"""Masks."""

IntArray = NDArray[np.intp]
"""Indices and counts."""

StampArray = NDArray[np.int64]
"""Stamps, integer nanoseconds."""

ByteArray = NDArray[np.uint8]
"""Bytes of sonar images and messages."""

if TYPE_CHECKING:
    Slice = slice[int, int, None]
else:
    Slice = slice
"""Contiguous part of an array; builtin slices accept no type arguments at run time."""
