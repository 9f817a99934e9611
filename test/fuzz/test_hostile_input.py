"""No foreign file shows a traceback, hangs, takes the memory or is changed: a seeded minute."""

from collections.abc import Mapping

import pytest
from hostile.campaign import Tally, campaign
from hostile.child import Job
from hostile.registry import TARGETS

SEED = 16


@pytest.fixture(scope='module')
def tallies(tmp_path_factory: pytest.TempPathFactory) -> Mapping[str, Tally]:
    """What broke a reader before, and new inputs, the same on every machine."""
    keep = str(tmp_path_factory.mktemp('broke'))
    return campaign(
        [Job(name, SEED, target.examples, 120.0, True, keep) for name, target in TARGETS.items()]
    )


@pytest.mark.timeout(600)
@pytest.mark.parametrize('name', TARGETS)
def test_hostile_input_ends_in_a_sentence(name: str, tallies: Mapping[str, Tally]) -> None:
    assert not tallies[name].told, '\n'.join(tallies[name].told)
    assert tallies[name].inputs >= TARGETS[name].examples // 2
