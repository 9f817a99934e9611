"""Memory that is kept for the next large array rather than handed back to the system."""

import ctypes
import sys
from functools import cache
from os import environ

MMAP_THRESHOLD, TRIM_THRESHOLD = -3, -1
"""Numbers of glibc's options."""

SETTINGS = 'MALLOC_MMAP_THRESHOLD_', 'MALLOC_TRIM_THRESHOLD_', 'GLIBC_TUNABLES'
"""Variables by which a user sets them."""

OF_DASK = {'MALLOC_TRIM_THRESHOLD_': '65536'}
"""Variable that Dask sets for each of its workers: a fifth of a study went into new pages."""

LARGE = 32 * 2**20
"""Size (bytes) up to which an array's memory is kept; of twice that, all that is free is handed
back."""


@cache
def keep_freed_memory() -> bool:
    """Have the C library keep freed memory, and tell whether it does.

    Matrices and their factors take a megabyte or two each and live for a few milliseconds. Handed
    back to the system every time, their pages are asked for and cleared anew, which takes a tenth
    of a steady state's time or more. Only glibc has these options; settings of the user stand.
    """
    if not sys.platform.startswith('linux'):
        return False
    if any(environ.get(name, OF_DASK.get(name)) != OF_DASK.get(name) for name in SETTINGS):
        return False
    library = ctypes.CDLL(None)
    if not hasattr(library, 'gnu_get_libc_version'):
        return False
    return bool(
        library.mallopt(MMAP_THRESHOLD, LARGE) and library.mallopt(TRIM_THRESHOLD, 2 * LARGE)
    )
