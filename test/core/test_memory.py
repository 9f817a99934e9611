"""Freed memory is kept, so that a matrix after a matrix costs no new pages."""

import subprocess
import sys

import pytest
from dask import config

from trawl_ros.core.memory import DASK_VARIABLES

LOOP = """
import resource
import numpy as np
{first}
def pages():
    for _ in range(50):
        np.ones(200_000)
pages()
before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
pages()
print(resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before)
"""

KEEP = 'from trawl_ros.core.memory import keep_freed_memory; kept = keep_freed_memory()'


def _run(first: str, **environment: str) -> str:
    command = [sys.executable, '-c', LOOP.format(first=first)]
    done = subprocess.run(command, capture_output=True, text=True, check=True, env=environment)
    return done.stdout.strip()


@pytest.mark.skipif(not sys.platform.startswith('linux'), reason='glibc has the options')
def test_arrays_one_after_another_take_the_same_pages() -> None:
    assert int(_run(KEEP)) < 100


@pytest.mark.skipif(not sys.platform.startswith('linux'), reason='glibc has the options')
def test_settings_of_the_user_stand() -> None:
    told = _run(f'{KEEP}; print(kept)', MALLOC_TRIM_THRESHOLD_='131072').splitlines()
    assert told[0] == 'False'


@pytest.mark.skipif(not sys.platform.startswith('linux'), reason='glibc has the options')
def test_what_dask_sets_for_its_workers_is_no_setting_of_the_user() -> None:
    import distributed  # noqa: F401  its configuration

    own = config.get('distributed.nanny.pre-spawn-environ')
    assert {name: str(own[name]) for name in DASK_VARIABLES} == DASK_VARIABLES
    assert int(_run(KEEP, **DASK_VARIABLES)) < 100
