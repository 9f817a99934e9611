"""A tiny folder of trials with a key, made without a plant."""

import json

import pytest

from trawl_ros.lab.missing_effect.records import CauseRecord, KeyRecord, TruthRecord
from trawl_ros.lab.missing_effect.trials_folder import write_key
from trawl_ros.lab.trials.answers import right_leaves, right_nodes, right_sizes


@pytest.fixture(scope='session')
def truth():
    """Function from names of hidden causes to the truth of a trial."""

    def made(*causes, series='alone', strength=3.0, size=-0.3):
        return TruthRecord(
            series=series,
            strength=strength,
            causes=tuple(
                CauseRecord(
                    name=name, size=size, unit='', leaves=right_leaves(name),
                    nodes=right_nodes(name), sizes=dict(right_sizes(name, size)),
                )
                for name in causes
            ),
            coefficients=(1.0,) * 12,
            floor={'door_spread': 0.5},
        )  # fmt: skip

    return made


@pytest.fixture
def trials(tmp_path, truth):
    """Folder of two trials: a lost chain, and nothing."""
    folder = tmp_path / 'trials'
    folder.mkdir()
    key = KeyRecord(
        seed=1,
        gear='kaifuha',
        form='windows',
        trials={
            'trial_000': truth('footrope_chain'),
            'trial_002': truth(series='clean', strength=0.0),
        },
        not_possible={'trial_001': 'cannot be towed'},
    )
    write_key(folder, key)
    return folder


CHAIN = 'mouth/weight/footrope_weight'


def answers():
    """Right answers to both."""
    return {
        'method': 'mine',
        'trials': {
            'trial_000': {
                'verdict': 'NAMED',
                'named': [CHAIN],
                'among': [CHAIN],
                'probabilities': {'nothing': 0.01, CHAIN: 0.97, 'mouth/lift': 0.02},
                'sizes': {CHAIN: {'value': -0.28, 'low': -0.35, 'high': -0.2}},
                'seconds': 2.0,
            },
            'trial_002': {'verdict': 'NO_DISCREPANCY', 'probabilities': {'nothing': 0.9}},
        },
    }


@pytest.fixture
def answered(tmp_path):
    """Function that writes a file of answers, changed by a function of its content."""

    def written(change=None):
        content = answers()
        if change is not None:
            change(content)
        path = tmp_path / 'answers.json'
        path.write_text(json.dumps(content))
        return path

    return written
