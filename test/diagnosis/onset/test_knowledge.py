"""What an identification found of boards and errors is what a tow is watched with."""

import json
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from trawl_ros.core.errors import TrawlError
from trawl_ros.core.time import SECOND
from trawl_ros.diagnosis.onset.knowledge import STATED, of_identification
from trawl_ros.diagnosis.onset.tows import LESS_KNOWN, by_estimate
from trawl_ros.estimation.fit.error_terms import GROUPS
from trawl_ros.estimation.motion.processes import ErrorSizes
from trawl_ros.records.coefficients import COEFFICIENTS

PLACE = GROUPS.index('tension')
FOUND = ErrorSizes().having(PLACE, 3.2, 0.05, 1.4, 0.4)


@pytest.fixture
def written(tmp_path):
    """Write an identification.json that has more keys than it must have."""

    def write(**more):
        known = {
            'coefficients': {name: {'value': 1.0} for name in COEFFICIENTS},
            'covariance': np.eye(12).tolist(),
        }
        path = tmp_path / 'identification.json'
        path.write_text(json.dumps(known | more))
        return path

    return write


def test_errors_are_as_found_and_never_less_than_stated(written):
    record = FOUND.record() | {'log': 3.0}
    known = of_identification(written(noise_densities={'speed': 0.07}, chain={'sizes': record}))
    assert known.densities == {'speed': 0.07}
    assert known.sizes.log == 3.0
    # A drift of 0.05 and 0.4 of what changes with states are less than stated.
    assert known.sizes.of_group(PLACE).tolist() == [3.2, 0.1, 1.4, 1.0, 0.05]
    assert known.sizes.of_group(PLACE + 1).tolist() == STATED.of_group(PLACE + 1).tolist()


@pytest.mark.parametrize('more', [{}, {'chain': None}, {'chain': {'refused': 'not at sea'}}])
def test_a_file_that_does_not_tell_errors_has_them_as_stated(written, more):
    known = of_identification(written(**more))
    assert known.densities == {}
    assert known.sizes == STATED


@pytest.mark.parametrize(
    'more',
    [
        {'noise_densities': {'speed': float('nan')}},
        {'noise_densities': ['speed']},
        {'chain': {'sizes': {'log': float('inf')}}},
        {'chain': {'sizes': {'noise': {'tension': 'much'}}}},
        {'chain': {'sizes': {'noise': {'tension': -1.0}}}},
        {'noise_densities': {'speed': 1e300}},
        {'noise_densities': {'speed': 10**400}},
        {'covariance': [[float('inf')] * 12] * 12},
        {'covariance': [['inf'] * 12] * 12},
        {'covariance': (1e5 * np.eye(12)).tolist()},
        {'coefficients': {name: {'value': 1e17} for name in COEFFICIENTS}},
        {'coefficients': {name: {'value': 'nan'} for name in COEFFICIENTS}},
    ],
)
def test_errors_that_are_no_numbers_are_refused(written, more):
    with pytest.raises(TrawlError, match=r'identification\.json'):
        of_identification(written(**more))


def test_windows_of_the_same_tows_tell_boards_and_errors():
    window = SimpleNamespace(start_ns=0, end_ns=100 * SECOND, noise={'speed': 0.01})
    estimate = SimpleNamespace(values=np.ones(13), covariance=np.eye(13))
    known = by_estimate(estimate, slice(0, 12), [window])
    assert known.densities == {'speed': pytest.approx(0.1)}
    assert known.covariance.tolist() == (LESS_KNOWN**2 * np.eye(12)).tolist()


@pytest.mark.parametrize('text', ['[' * 100_000, '9' * 100_000, '{', '', '{"a": NaN}', '\udcff'])
def test_what_is_no_estimate_is_refused_in_a_sentence(tmp_path, text):
    path = tmp_path / 'identification.json'
    path.write_text(text, errors='surrogateescape')
    with pytest.raises(TrawlError, match=r'identification\.json.*expected') as refusal:
        of_identification(path)
    assert len(str(refusal.value)) < 400


def test_a_device_and_a_huge_file_are_refused_at_once(tmp_path):
    huge = tmp_path / 'huge.json'
    with huge.open('wb') as file:
        file.truncate(10**10)
    for path in (Path('/dev/zero'), tmp_path, huge):
        with pytest.raises(TrawlError, match='expected'):
            of_identification(path)
