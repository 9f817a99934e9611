"""``trawl tow`` makes the same bag again, and refuses what it cannot tow."""

import os
import signal
import subprocess
import sys
import time

import pytest

from trawl_ros.bags.reader import read_messages, summarise
from trawl_ros.messages.stamps import stamp_of


def contents(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def test_the_same_seed_gives_the_same_bytes_and_another_seed_others(run, trial, tmp_path):
    first, again, other = (tmp_path / name / 'bag' for name in ('first', 'again', 'other'))
    assert run('tow', trial, '--out', first).exit_code == 0
    assert run('tow', trial, '--out', again).exit_code == 0
    assert contents(first) == contents(again)
    trial.write_text(trial.read_text().replace('seed: 5', 'seed: 6'))
    assert run('tow', trial, '--out', other).exit_code == 0
    assert contents(first)['bag_0.mcap'] != contents(other)['bag_0.mcap']


def test_instruments_and_truth_come_at_their_rates(run, trial, tmp_path):
    done = run('tow', trial, '--out', tmp_path / 'bag')
    summary = summarise(tmp_path / 'bag')
    counts = {topic.topic: topic.count for topic in summary.topics}
    assert summary.problems == ()
    assert counts['/trawl/truth/winch'] == 61
    assert counts['/trawl/truth/gear'] == 7
    assert counts['/trawl/sonar/pressure'] == 7
    assert (summary.start, summary.end) == (0, 6_000_000_000)
    for topic, count in counts.items():
        assert f'{count:8d}  {topic}' in done.stdout
    assert '× real time' in done.stdout


def test_the_end_is_printed_in_the_units_of_a_bridge(run, trial, tmp_path):
    done = run('tow', trial, '--out', tmp_path / 'bag', '--units', 'sea,depth=fm')
    *_, place, doors, mouth, tension = done.stdout.splitlines()
    assert ' m of warp at ' in place
    assert place.endswith(' kn:')
    assert doors.endswith(' fm deep')
    assert ' m wide, headrope ' in mouth
    assert ' t on a warp' in tension


def test_a_refusal_is_in_the_units_of_a_bridge(run, trial, tmp_path):
    trial.write_text(trial.read_text().replace('warp_length_m: 500.0', 'warp_length_m: 10.0'))
    done = run('tow', trial, '--out', tmp_path / 'bag', '--units', 'imperial')
    assert done.exit_code == 1
    assert 'warp 5 fm at 4.08 kn: the gear' in done.stderr


def test_only_what_the_scenario_records_is_recorded(run, trial, tmp_path):
    trial.write_text(f'{trial.read_text()}record: [instruments]\ntruth_rate_hz: 1.0\n')
    assert run('tow', trial, '--out', tmp_path / 'bag').exit_code == 0
    counts = {topic.topic: topic.count for topic in summarise(tmp_path / 'bag').topics}
    assert not any('/truth/' in topic for topic in counts)
    assert counts['/trawl/winch/joint_states'] == 7


def test_the_stamp_is_when_it_was_sampled(run, trial, tmp_path):
    assert run('tow', trial, '--out', tmp_path / 'bag').exit_code == 0
    for received in read_messages(tmp_path / 'bag', ['/trawl/truth/winch', '/trawl/door/spread']):
        assert stamp_of(received.message) == received.log_time


def test_what_exists_is_not_written_over(run, trial, tmp_path):
    (tmp_path / 'bag').mkdir()
    (tmp_path / 'bag' / 'mine').write_text('mine')
    done = run('tow', trial, '--out', tmp_path / 'bag')
    assert done.exit_code == 1
    assert str(tmp_path / 'bag') in done.stderr
    assert [path.name for path in (tmp_path / 'bag').iterdir()] == ['mine']


@pytest.mark.parametrize(
    ('old', 'new', 'said'),
    [
        ('seed: 5', 'seeed: 5', 'seeed'),
        ('speed_m_s: 2.1', 'speed_m_s: -2.1', 'start.speed_m_s'),
        ('gear: coarse.yaml', 'gear: kaifuga', 'kaifuga'),
        # On ten metres of warp the gear comes up to the surface.
        ('warp_length_m: 510.0', 'warp_length_m: 10.0', "step 'veer'"),
        ('warp_length_m: 500.0', 'warp_length_m: 10.0', 'start: warp 10 m'),
    ],
)
def test_a_scenario_that_cannot_be_towed_is_refused_in_one_sentence(
    run, trial, tmp_path, old, new, said
):
    trial.write_text(trial.read_text().replace(old, new))
    done = run('tow', trial, '--out', tmp_path / 'bag')
    assert done.exit_code == 1
    assert done.stderr.splitlines()[-1].startswith(f'Error: {trial}: ')
    assert said in done.stderr
    assert not (tmp_path / 'bag').exists()


def test_a_missing_scenario_is_named(run, tmp_path):
    done = run('tow', tmp_path / 'none.yaml', '--out', tmp_path / 'bag')
    assert done.exit_code == 1
    assert str(tmp_path / 'none.yaml') in done.stderr
    assert ' demo' in run('tow', 'dmeo', '--out', tmp_path / 'bag').stderr


@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGTERM])
def test_interrupted_it_leaves_a_bag_that_can_be_read(trial, tmp_path, number):
    trial.write_text(trial.read_text().replace('minutes: 0.05', 'minutes: 60'))
    bag = tmp_path / 'bag'
    process = subprocess.Popen(
        [sys.executable, '-c', 'from trawl_ros.cli.main import main; main()',
         'tow', str(trial), '--out', str(bag)],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=os.environ,
    )  # fmt: skip
    try:
        deadline = time.monotonic() + 60.0
        while not bag.exists() and process.poll() is None and time.monotonic() < deadline:
            time.sleep(0.05)
        time.sleep(0.5)
        process.send_signal(number)
        output, errors = process.communicate(timeout=20.0)
    finally:
        process.kill()
        process.wait()
    assert process.returncode == 130, errors
    assert 'Traceback' not in errors
    summary = summarise(bag)
    assert summary.problems == ()
    assert summary.count > 0
    assert f'{summary.count} messages' in output
