# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Machine of the benchmark: processor, software, threads."""

import os
import platform
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from trawl_ros.core.version import __version__

LIBRARIES = ('numpy', 'scipy', 'numba', 'moordyn', 'MoorPy', 'trawlkit')
CPU_INFO = Path('/proc/cpuinfo')


def cpu_model() -> str:
    """Name of the processor, as the system reports it."""
    if CPU_INFO.is_file():
        for line in CPU_INFO.read_text().splitlines():
            key, _, value = line.partition(':')
            if key.strip() == 'model name':
                return value.strip()
    return platform.processor() or platform.machine()


def software() -> dict[str, str]:
    """Names and versions of the measured programs and their platform; absent ones are left out."""
    found = {'trawl_ros': __version__, 'Python': platform.python_version()}
    for name in LIBRARIES:
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            continue
    return found


def blas_threads() -> str:
    """Number of threads that BLAS was limited to."""
    return os.environ.get('OPENBLAS_NUM_THREADS', 'not limited')
