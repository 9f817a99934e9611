"""``trawl missing-effect`` from outside."""

import json

from trawl_ros.lab.missing_effect.records import KeyRecord, TruthRecord
from trawl_ros.lab.missing_effect.trials_folder import write_key

ANSWERS = {
    'method': 'mine',
    'trials': {'trial_000': {'verdict': 'NO_DISCREPANCY', 'probabilities': {'nothing': 0.9}}},
}


def folder_of(tmp_path):
    """Folder with one clean trial, and its key."""
    folder = tmp_path / 'trials'
    folder.mkdir()
    clean = TruthRecord(series='clean', strength=0.0)
    write_key(
        folder,
        KeyRecord(
            seed=1, gear='kaifuha', form='windows', trials={'trial_000': clean}, not_possible={}
        ),
    )
    return folder


def test_answers_of_two_methods_are_scored_and_compared_in_a_report(run, tmp_path):
    folder = folder_of(tmp_path)
    files = []
    for name in ('mine', 'other'):
        files.append(tmp_path / f'{name}.json')
        files[-1].write_text(json.dumps({**ANSWERS, 'method': name}))
    done = run('missing-effect', 'score', folder, *files, '--out', tmp_path / 'report')
    assert done.exit_code == 0, done.output
    assert 'mine' in done.output
    assert 'other' in done.output
    assert '0 % (0 of 1)' in done.output
    assert 'mine' in (tmp_path / 'report' / 'missing_effect.md').read_text()
    again = run('missing-effect', 'score', folder, *files, '--out', tmp_path / 'report')
    assert again.exit_code == 1
    (tmp_path / 'copy.json').write_text(files[0].read_text())
    twice = run('missing-effect', 'score', folder, *files, tmp_path / 'copy.json')
    assert twice.exit_code == 1
    assert 'mine again' in twice.output


def test_a_wrong_file_of_answers_ends_with_one_sentence(run, tmp_path):
    folder = folder_of(tmp_path)
    path = tmp_path / 'answers.json'
    path.write_text(json.dumps({'method': 'mine', 'trials': {}}))
    done = run('missing-effect', 'score', folder, path)
    assert done.exit_code == 1
    assert 'trial_000' in done.output
    assert 'Traceback' not in done.output
    done = run('missing-effect', 'score', tmp_path / 'nowhere', path)
    assert done.exit_code == 1
    assert 'nowhere' in done.output


def test_a_call_without_what_it_needs_is_wrong_usage(run, tmp_path):
    assert run('missing-effect', 'make', tmp_path / 'new', '--trials', 1).exit_code == 2
    assert run('missing-effect', 'score', tmp_path).exit_code == 2
    refused = run('missing-effect', 'answer', tmp_path / 'nowhere', '--out', tmp_path / 'out')
    assert refused.exit_code == 1
    assert not (tmp_path / 'out').exists()
