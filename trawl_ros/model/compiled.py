"""Compilation of loops, cached beside the module so that only the first start pays for it."""

from typing import Any

import numpy as np
from numba import njit

compiled: Any = njit(cache=True, error_model='numpy')

fused: Any = njit(cache=True, error_model='numpy', fastmath={'contract', 'reassoc', 'nsz'})
"""The same for sums of products, which may be fused and taken in any order."""


def alike(*arrays: np.ndarray) -> list[np.ndarray]:
    """Arrays of one kind, all real or all complex, as compiled loops take them."""
    kind = complex if 'c' in [array.dtype.kind for array in arrays] else float
    return [np.ascontiguousarray(array, kind) for array in arrays]
