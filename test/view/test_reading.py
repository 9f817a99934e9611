"""Messages become records in whatever order they come, and hostile ones a sentence."""

from dataclasses import replace

import numpy as np
import pytest

from trawl_ros.core.errors import MessageError
from trawl_ros.core.time import SECOND
from trawl_ros.messages.cdr import deserialize
from trawl_ros.messages.diagnostics import OK, Status, diagnostic_array
from trawl_ros.messages.markers import gear_markers
from trawl_ros.messages.to_messages import sample_message
from trawl_ros.messages.truth_to_messages import truth_messages
from trawl_ros.plots.records import Quantities
from trawl_ros.records.samples import FixSample, HeadingSample
from trawl_ros.view.reading import TOPICS, TowReader
from trawl_ros.view.records import Coefficients, Fix, Gear, Note, ShipPose, Sweep
from trawl_ros.view.series import Unwrapped
from trawl_ros.view.ship import MOST_POINTS, Track


@pytest.fixture
def reader(gear):
    return TowReader(gear)


def taken(reader, *messages):
    """Records of messages, each given as (topic, message)."""
    shown = (topic_message for topic_message in messages if topic_message[0] in TOPICS)
    return [record for topic, message in shown for record in reader.take(topic, message)]


def of(kind, records):
    return [record for record in records if isinstance(record, kind)]


def test_fixes_and_compass_move_the_ship_where_no_truth_does(reader):
    fixes = [FixSample(k * SECOND, 60.0 + 1e-5 * k, 5.0, 1.0) for k in range(3)]
    heading = HeadingSample(0, 1.0, 0.01)
    poses = of(ShipPose, taken(reader, *map(sample_message, (heading, *fixes))))
    assert [pose.heading for pose in poses] == [1.0] * 3
    norths = [pose.position[1] for pose in poses]
    # A hundred-thousandth of a degree of latitude at 60 degrees.
    np.testing.assert_allclose(norths, [0.0, 1.11413, 2.22826], atol=1e-4)


def test_fixes_leave_the_ship_where_truth_has_her(reader, known):
    truth = known.truth_at(7.0)
    fix = FixSample(truth.stamp, 60.0, 5.0, 1.0)
    records = taken(reader, *truth_messages(truth), sample_message(fix))
    (pose,), (place,) = of(ShipPose, records), of(Fix, records)
    np.testing.assert_allclose(pose.position, truth.vessel.position)
    np.testing.assert_allclose(place.position[:2], truth.vessel.position[:2])


def test_a_sweep_needs_image_and_scan_of_one_stamp_in_any_order(reader, known):
    messages = [sample_message(sample) for sample in known.sweep_of(known.truth_at(0.0))]
    image, scan = messages[:2]
    later = [sample_message(sample) for sample in known.sweep_of(known.truth_at(10.0))]
    assert len(of(Sweep, taken(reader, scan, image))) == 1
    assert of(Sweep, taken(reader, image, later[1])) == []


def test_beams_of_image_and_scan_must_agree(reader, known):
    image, scan = list(known.sweep_of(known.truth_at(0.0)))[:2]
    fewer = replace(image, image=image.image[:-1])
    with pytest.raises(MessageError, match=r'179 beams, .*sonar/scan .*180'):
        taken(reader, sample_message(fewer), sample_message(scan))


def test_markers_draw_the_gear_and_truth_once_they_are_silent(reader, known):
    sources = []
    for second in range(60):
        truth = known.truth_at(second)
        messages = truth_messages(truth)
        if second < 20:
            topic, drawn = gear_markers(known.picture_of(truth))
            messages.append((topic, deserialize(drawn.data, drawn.__msgtype__)))
        sources += [gear.source for gear in of(Gear, taken(reader, *messages))]
    assert sources[:20] == ['truth'] * 20
    (later,) = set(sources[20:])
    assert later.startswith('truth of doors and mouth')
    assert len(sources) == pytest.approx(50, abs=3)


def test_truth_draws_the_doors_where_they_are(reader, known):
    drawn = []
    for second in range(6):
        drawn += of(Gear, taken(reader, *truth_messages(known.truth_at(second))))
    gear = drawn[-1]
    (warp,) = (strand for strand in gear.strands if strand.name == 'port_warp')
    (second,) = (s for s in range(6) if known.truth_at(s).stamp == gear.stamp)
    door = known.truth_at(second).doors[0].position
    np.testing.assert_allclose(warp.pieces[-1, -1], door, atol=1e-6)


def test_a_repeated_status_is_shown_once(reader, known):
    messages = [(topic, message) for _, topic, message in known.estimate_messages()]
    records = taken(reader, *messages)
    assert [record.windows for record in of(Coefficients, records)] == [1, 2, 3]
    assert len({(note.stamp, note.source, note.text) for note in of(Note, records)}) == 4


@pytest.mark.parametrize('value', ['', 'nan', 'much', '1e999'])
def test_an_estimate_without_a_number_is_refused(reader, value):
    status = Status(
        'identification: coefficients',
        OK,
        '',
        {'a1': value, 'a1 determined': 'true', 'windows': '1'},
    )
    with pytest.raises(MessageError, match=f"^identification: coefficients: a1 is '{value}'"):
        taken(reader, ('identification/status', diagnostic_array(0, [status])))


def test_what_a_note_repeats_is_one_line_without_control_characters(reader):
    status = Status('discrepancy: verdict', OK, '\x1b[31mred\nmore' + 'x' * 5000, {})
    (note,) = taken(reader, ('discrepancy/findings', diagnostic_array(0, [status])))
    assert note.text == '?[31mred'


def test_missing_readings_make_no_gear(reader, known):
    samples = [s for s in known.samples_of(known.truth_at(0.0)) if isinstance(s, HeadingSample)]
    records = []
    for second in range(10):
        moved = (replace(sample, stamp=second * SECOND) for sample in samples)
        records += taken(reader, *map(sample_message, moved))
    assert of(Gear, records) == []
    assert len(of(Quantities, records)) == 10


def test_a_long_track_has_no_more_points_than_a_short_one():
    track, longest = Track(), 0
    for k in range(20_000):
        points = track.take(np.array([3.0 * k, 0.0]))
        longest = max(longest, 0 if points is None else len(points))
    assert 0.4 * MOST_POINTS < longest <= MOST_POINTS + 1


def test_angles_go_on_through_a_turn_and_over_gaps():
    angles = np.linspace(0.0, 20.0, 50)
    turns = Unwrapped()
    wrapped = np.remainder(angles + np.pi, 2.0 * np.pi) - np.pi
    shown = [turns.take('heading', angle) for angle in wrapped]
    np.testing.assert_allclose(shown, angles)
    assert np.isnan(turns.take('heading', float('nan')))
