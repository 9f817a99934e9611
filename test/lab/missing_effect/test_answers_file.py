"""Files of answers are read, and each error says what is wrong and where."""

import json

import pytest

from trawl_ros.core.errors import TrawlError
from trawl_ros.lab.missing_effect.trials_folder import (
    key_file,
    make_trials,
    read_answers,
    read_key,
    read_trials,
)

CHAIN = 'mouth/weight/footrope_weight'


def test_right_answers_are_read(trials, answered):
    found = read_answers(answered(), read_trials(trials))
    first = found.trials['trial_000']
    assert first.of(CHAIN) == 0.97
    assert first.of('mouth') == pytest.approx(0.99)
    assert first.of('net') == 0.0


def first(content):
    return content['trials']['trial_000']


@pytest.mark.parametrize(
    ('change', 'words'),
    [
        (lambda own: own['trials'].pop('trial_002'), ('trial_002', 'missing')),
        (lambda own: own['trials'].update(trial_9={'verdict': 'UNKNOWN'}), ('trial_9', 'names of')),
        (lambda own: own.pop('method'), ('method',)),
        (lambda own: first(own).update(verdict='CERTAIN'), ('verdict', 'CERTAIN', 'NAMED')),
        (lambda own: first(own).update(named=[]), ('trial_000', 'named', 'NAMED')),
        (lambda own: first(own).update(named=['mouth/wieght']), ('mouth/wieght', 'mouth/weight')),
        (lambda own: first(own)['probabilities'].update({CHAIN: 1.2}), (CHAIN, '1.2')),
        (
            lambda own: first(own)['probabilities'].update(nothing=0.7, something_else=0.6),
            ('trial_000', 'nothing', 'something_else', '1.3'),
        ),
        (lambda own: first(own)['sizes'][CHAIN].update(low=0.1), ('low', '0.1', 'high')),
        (lambda own: first(own).update(speed=1.0), ('speed',)),
    ],
)
def test_a_wrong_file_is_refused_with_its_reason(trials, answered, change, words):
    path = answered(change)
    with pytest.raises(TrawlError) as error:
        read_answers(path, read_trials(trials))
    assert str(path) in str(error.value)
    for word in words:
        assert word in str(error.value)


def test_what_is_no_json_is_refused(trials, tmp_path):
    path = tmp_path / 'answers.json'
    path.write_text('verdict: NAMED')
    with pytest.raises(TrawlError, match=r'answers\.json.*JSON'):
        read_answers(path, read_trials(trials))


def test_a_key_of_other_trials_is_refused(trials):
    assert read_key(trials).seed == 1
    content = json.loads(key_file(trials).read_text())
    content['trials']['trial_002']['series'] = 'outside'
    key_file(trials).write_text(json.dumps(content))
    with pytest.raises(TrawlError, match='SHA-256'):
        read_key(trials)


def test_trials_of_another_seed_are_not_mixed(trials):
    with pytest.raises(TrawlError, match='seed 1, expected seed 2'):
        make_trials(trials, seed=2, trials=3)


def test_a_method_cannot_read_the_truth_in_the_folder(trials):
    for path in trials.rglob('*.json'):
        assert 'footrope_chain' not in path.read_text()
        assert '"seed"' not in path.read_text()
