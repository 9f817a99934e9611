"""No foreign file shows a traceback, hangs, takes the memory or is changed: seeded inputs.

All that broke a reader before, and of new inputs an eighth; the long tests give them all.
"""

from collections.abc import Mapping
from pathlib import Path

import pytest
from hostile.campaign import Tally, campaign
from hostile.child import Job
from hostile.registry import TARGETS

SEED = 16


QUICK = 8
"""One in so many of a target's new inputs is given where time is short."""


def given(folder: Path, part: int) -> Mapping[str, Tally]:
    """What came of the inputs that broke a reader, and of one in `part` of the new ones."""
    return campaign(
        [
            Job(name, SEED, target.examples // part, 120.0, True, str(folder))
            for name, target in TARGETS.items()
        ]
    )


@pytest.fixture(scope='module')
def tallies(tmp_path_factory: pytest.TempPathFactory) -> Mapping[str, Tally]:
    """What broke a reader before, and some new inputs, the same on every machine."""
    return given(tmp_path_factory.mktemp('broke'), QUICK)


@pytest.fixture(scope='module')
def all_tallies(tmp_path_factory: pytest.TempPathFactory) -> Mapping[str, Tally]:
    return given(tmp_path_factory.mktemp('broke_all'), 1)


def hold(tally: Tally, inputs: int) -> None:
    assert not tally.told, '\n'.join(tally.told)
    assert tally.inputs >= inputs // 2


@pytest.mark.timeout(600)
@pytest.mark.parametrize('name', TARGETS)
def test_hostile_input_ends_in_a_sentence(name: str, tallies: Mapping[str, Tally]) -> None:
    hold(tallies[name], TARGETS[name].examples // QUICK)


@pytest.mark.slow
@pytest.mark.timeout(600)
@pytest.mark.parametrize('name', TARGETS)
def test_all_hostile_input_ends_in_a_sentence(name: str, all_tallies: Mapping[str, Tally]) -> None:
    hold(all_tallies[name], TARGETS[name].examples)
