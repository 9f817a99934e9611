# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Setting of the C library to keep freed memory for the next large array."""

import ctypes
import sys
from functools import cache
from os import environ

M_MMAP_THRESHOLD, M_TRIM_THRESHOLD = -3, -1
"""Parameters of glibc's mallopt."""

USER_VARIABLES = 'MALLOC_MMAP_THRESHOLD_', 'MALLOC_TRIM_THRESHOLD_', 'GLIBC_TUNABLES'
"""Environment variables with which a user sets them."""

DASK_VARIABLES = {'MALLOC_TRIM_THRESHOLD_': '65536'}
"""Variable that Dask sets for its workers; with it, new pages took a fifth of a study's time."""

KEPT_BYTES = 32 * 2**20
"""Largest array whose memory is kept; free memory above twice this size is returned."""


@cache
def keep_freed_memory() -> bool:
    """Make the C library keep freed memory; return True if it does.

    Matrices and factors take one or two megabytes each and live for milliseconds. If their pages
    went back to the system each time, clearing new ones would take a tenth of the time of a steady
    state. Only glibc has these options. Settings of the user take precedence.
    """
    if not sys.platform.startswith('linux'):
        return False
    if any(
        environ.get(name, default) != default
        for name in USER_VARIABLES
        for default in (DASK_VARIABLES.get(name),)
    ):
        return False
    library = ctypes.CDLL(None)
    if not hasattr(library, 'gnu_get_libc_version'):
        return False
    return bool(
        library.mallopt(M_MMAP_THRESHOLD, KEPT_BYTES)
        and library.mallopt(M_TRIM_THRESHOLD, 2 * KEPT_BYTES)
    )
