"""Recordings hold what the bags do: entities, times and numbers, read back from the file."""

import numpy as np
import pytest
from click.testing import CliRunner

pytest.importorskip('rerun', reason='needs the extra `view`: make test-view installs it')

from trawl_ros.cli.main import trawl
from trawl_ros.core.time import SECOND
from trawl_ros.messages.markers import RAMP
from trawl_ros.plots import bag_messages
from trawl_ros.view import bags


def run(*arguments):
    return CliRunner().invoke(trawl, ['view', *map(str, arguments)])


@pytest.fixture(scope='module')
def recording(tow, estimates, read_back, tmp_path_factory):
    path = tmp_path_factory.mktemp('recordings') / 'tow.rrd'
    done = run(tow, estimates, '--out', path)
    assert done.exit_code == 0, done.output
    return read_back(path)


def test_one_recording_on_one_time_line_with_a_layout(recording):
    assert recording.applications == {'trawl_ros'}
    assert recording.timelines == {'time'}
    # Simulated time begins at 0, and is no date.
    assert recording.kinds == {'duration[ns]'}
    assert recording.blueprints >= 1


def test_series_have_the_stamps_and_numbers_of_the_bag_in_the_unit_of_their_panel(recording, known):
    root = '/histories'
    stamps = known.START + SECOND * np.arange(known.DURATION_S + 1)
    truths = [known.truth_at(second) for second in range(known.DURATION_S + 1)]
    expected = {
        'warp_length/port_length': [t.winches[0].length for t in truths],
        'warp_tension/starboard_tension': [1e-3 * t.winches[1].tension for t in truths],
        'height_over_the_surface/port_door_depth': [t.doors[0].position[2] for t in truths],
        'door_spread/door_spread': [80.0 for _ in truths],
        'height_over_the_surface/net_depth': [-t.net.headrope_depth for t in truths],
    }
    for path, values in expected.items():
        for kind, tolerance in (('truth', 1e-9), ('measured', 1e-3)):
            times, shown = recording.series(f'{root}/{path}/{kind}')
            assert times.tolist() == stamps.tolist(), path
            np.testing.assert_allclose(shown, values, rtol=tolerance)
    times, wanted = recording.series(f'{root}/warp_length/port_length/wanted')
    assert (times.tolist(), wanted.tolist()) == ([known.START + 90 * SECOND], [400.0])
    assert f'{root}/warp_length/starboard_length/wanted' not in recording.entities


def test_headings_are_compass_degrees_without_a_jump(recording, known):
    _, shown = recording.series('/histories/heading_from_north_by_east/heading/truth')
    expected = [90.0 - np.degrees(known.truth_at(k).vessel.heading) for k in (0, 120)]
    np.testing.assert_allclose(np.cos(np.radians(shown[[0, -1]] - expected)), 1.0)
    assert np.abs(np.diff(shown)).max() < 1.0


def test_the_gear_has_its_places_and_the_colours_of_its_tension(recording, known):
    rows = recording.rows('/map/gear/port_warp')
    assert len(rows) == known.DURATION_S + 1
    for (stamp, row), second in zip(rows, range(known.DURATION_S + 1), strict=True):
        truth = known.truth_at(second)
        line = known.picture_of(truth).lines[0].points
        assert stamp == truth.stamp
        np.testing.assert_allclose(np.concatenate(row['strips']), line, rtol=1e-6, atol=1e-3)
    (colour,) = rows[0][1]['colors']
    red, green, blue = (colour >> shift & 255 for shift in (24, 16, 8))
    # 150 of 200 kN are a quarter before the last of three pieces of the ramp ends.
    expected = RAMP[2] + 0.25 * (RAMP[3] - RAMP[2])
    np.testing.assert_allclose([red, green, blue], 255 * expected, atol=1.0)
    door = recording.rows('/map/gear/door_port')[0][1]
    np.testing.assert_allclose(door['centers'][0], known.truth_at(0).doors[0].position, rtol=1e-6)
    np.testing.assert_allclose(2.0 * np.array(door['half_sizes'][0])[[0, 2]], [2.0, 4.0])


def test_the_ship_goes_where_she_went(recording, known):
    rows = recording.rows('/map/ship')
    truth = known.truth_at(60)
    (row,) = (row for stamp, row in rows if stamp == truth.stamp)
    np.testing.assert_allclose(row['translation'][0], truth.vessel.position, rtol=1e-6)
    turned = row['quaternion'][0]
    yaw = 2.0 * np.arctan2(turned[2], turned[3])
    assert np.cos(yaw - truth.vessel.heading) == pytest.approx(1.0)
    track = recording.rows('/top/track')[-1][1]['strips'][0]
    assert np.hypot(*(track[-1] - truth_from_above(known, 120))) < 6.0


def truth_from_above(known, second):
    return known.truth_at(second).vessel.position[:2] * [1.0, -1.0]


def test_sweeps_are_laid_out_with_what_is_read_off(recording):
    rows = recording.rows('/sonar/image')
    assert len(rows) == 13
    image = rows[0][1]
    (form,) = image['format']
    assert (form['width'], form['height']) == (480, 480)
    echoes = np.array(image['buffer'][0], dtype=np.uint8).reshape(480, 480)
    assert echoes.max() == 230
    assert recording.rows('/sonar/opening_height')[0][1]['labels'] == ['height 50.0 m']
    assert len(recording.rows('/sonar/truth')[0][1]['positions']) == 6


def test_intervals_narrow_and_innovations_come_at_their_windows(recording, known):
    stamps = [known.START + second * SECOND for second in known.WINDOWS_AT_S]
    for k, what in enumerate(('value', 'low', 'high')):
        times, shown = recording.series(f'/estimate/b3/{what}')
        assert times.tolist() == stamps
        expected = [known.interval('b3', window)[k] for window in (1, 2, 3)]
        np.testing.assert_allclose(shown, expected, rtol=1e-5)
    times, shown = recording.series('/innovations/door_spread')
    assert (times.tolist(), set(shown)) == (stamps, {known.DEVIATIONS})
    text = recording.rows('/estimates')[-1][1]['text'][0]
    assert '| b3 | 5.000 | 4.667 … 5.333 | yes |' in text


def test_findings_are_told_with_what_they_rest_on(recording, known):
    (path,) = (path for path in recording.entities if path.startswith('/notes/discrepancy'))
    ((stamp, row),) = recording.rows(path)
    assert stamp == known.START + 90 * SECOND
    assert row['text'] == [f'{known.FINDING}; verdict NAMED, windows 3']
    assert row['level'] == ['WARN']


def test_readings_alone_draw_the_gear_and_say_so(readings, read_back, tmp_path):
    done = run(readings, '--out', tmp_path / 'readings.rrd')
    assert done.exit_code == 0, done.output
    found = read_back(tmp_path / 'readings.rrd')
    assert '/map/gear/port_warp' in found.entities
    notes = [row['text'][0] for _, row in found.rows('/notes/view')]
    assert any('as measured' in text for text in notes)
    assert not any(path.endswith('/truth') for path in found.entities)


def test_many_messages_are_thinned_out_and_that_is_told(tow, read_back, tmp_path, monkeypatch):
    monkeypatch.setattr(bag_messages, 'MOST_MESSAGES', 50)
    monkeypatch.setattr(bags, 'MOST_PICTURES', 10)
    done = run(tow, '--out', tmp_path / 'tow.rrd')
    assert done.exit_code == 0, done.output
    assert 'winch/joint_states: one of 3 of its 121 messages' in done.stderr
    found = read_back(tmp_path / 'tow.rrd')
    times, _ = found.series('/histories/warp_length/port_length/measured')
    assert len(times) == 41
    assert len(found.rows('/map/gear/port_warp')) == 10


def test_two_tows_are_not_laid_over_each_other(tow, readings, tmp_path):
    done = run(tow, readings, '--out', tmp_path / 'tow.rrd')
    assert done.exit_code == 1
    assert 'bags of one tow' in done.stderr
    assert not (tmp_path / 'tow.rrd').exists()


def test_a_file_is_replaced_when_asked_alone(tow, tmp_path):
    path = tmp_path / 'tow.rrd'
    path.write_text('mine')
    done = run(tow, '--out', path)
    assert done.exit_code == 1
    assert 'exists already' in done.stderr
    assert path.read_text() == 'mine'
    assert run(tow, '--out', path, '--force').exit_code == 0
    assert path.read_bytes()[:4] != b'mine'


def test_a_bag_of_somebody_else_is_refused(estimates, tmp_path):
    done = run(estimates, '--out', tmp_path / 'tow.rrd', '--namespace', 'other')
    assert done.exit_code == 1
    assert str(estimates) in done.stderr
    assert 'none of the topics' in done.stderr
