"""`check_bag` finds what is wrong with a bag, and nothing where nothing is."""

import numpy as np
import pytest
import yaml
from mcap.reader import make_reader
from mcap.writer import IndexType, Writer
from rosbags.interfaces import QosDurability, QosReliability

from trawl_ros.bags.check import check_bag
from trawl_ros.bags.storage.qos import dump_profiles, project_profile
from trawl_ros.bags.writer import BagWriter
from trawl_ros.core.errors import BagError
from trawl_ros.messages.cdr import message_definition, serialize
from trawl_ros.messages.estimates import estimate_message
from trawl_ros.messages.to_messages import sample_message
from trawl_ros.records.samples import PressureSample, RangeSample
from trawl_ros.records.topics import INSTRUMENTS, TRUTH, absolute

SECOND = 1_000_000_000
START = 1_785_000_000 * SECOND
PRESSURE = '/trawl/door/port/pressure'


def pressures(stamps):
    return [PressureSample(START + round(stamp * SECOND), 'port', 1e6, 1e3) for stamp in stamps]


def write(path, samples, *, log=lambda number, stamp: stamp):
    with BagWriter(path) as bag:
        for number, sample in enumerate(samples):
            topic, message = sample_message(sample)
            data = serialize(message)
            bag.write(absolute(topic), message.__msgtype__, data, log(number, sample.stamp))
    return path


def found(path, **options):
    return [(finding.kind, finding.topic) for finding in check_bag(path, **options).findings]


def text(path, **options):
    (finding,) = check_bag(path, **options).findings
    return finding.text


def test_a_sound_bag_is_sound(sound_bag):
    check = check_bag(sound_bag)
    assert check.findings == ()
    assert check.sound
    pressure, winch = check.topics
    assert (pressure.topic, pressure.count, pressure.group) == (PRESSURE, 300, 'instruments')
    assert (pressure.rate, pressure.usual_rate, pressure.longest_gap_s) == (1.0, 1.0, 1.0)
    assert pressure.lag_s == (0.0, 0.0)
    assert winch.qos == 'reliable, volatile, last 100'
    assert (check.count, check.end - check.start) == (600, 299 * SECOND)


def test_what_the_contract_has_and_the_bag_has_not_is_told_by_group(sound_bag):
    missing = check_bag(sound_bag).missing
    assert missing['truth'] == tuple(topic.name for topic in TRUTH)
    assert len(missing['instruments']) == len(INSTRUMENTS) - 2
    assert 'winch/joint_states' not in missing['instruments']


def test_missing_topics_are_findings_where_they_are_required(sound_bag):
    assert found(sound_bag, required=['winch/joint_states']) == []
    assert found(sound_bag, required=['door/spread']) == [('missing', '/trawl/door/spread')]
    assert found(sound_bag, required=['/lab/salinity']) == [('missing', '/lab/salinity')]
    assert len(found(sound_bag, required=['truth'])) == len(TRUTH)
    with pytest.raises(BagError, match='door/width: neither a group nor a topic; expected truth'):
        check_bag(sound_bag, required=['door/width'])


def test_a_pause_is_found_with_its_length_and_place(tmp_path):
    stamps = [*range(100), *range(130, 200)]
    check = check_bag(write(tmp_path / 'bag', pressures(stamps)))
    (finding,) = check.findings
    assert (finding.kind, finding.topic) == ('gap', PRESSURE)
    assert 'pauses 1 times' in finding.text
    assert 'longest 31 s' in finding.text
    assert check.topics[0].gap_start == START + 99 * SECOND


@pytest.mark.parametrize(('silent_s', 'kinds'), [(290, []), (310, ['gap'])])
def test_an_acoustic_sensor_may_be_silent_for_minutes(tmp_path, silent_s, kinds):
    stamps = [*range(0, 90, 3), *range(90 + silent_s, 600, 3)]
    spreads = [
        RangeSample(START + stamp * SECOND, 'spread', 120.0, 0.4, 1.0, 400.0) for stamp in stamps
    ]
    assert [kind for kind, _ in found(write(tmp_path / 'bag', spreads))] == kinds


def test_pauses_as_short_as_a_lost_message_or_two_are_none(tmp_path):
    stamps = [second for second in range(200) if second % 10 not in (4, 5)]
    assert found(write(tmp_path / 'bag', pressures(stamps))) == []


@pytest.mark.parametrize(
    ('interval', 'kinds'), [(0.05, ['rate']), (0.1, []), (5.0, []), (20.0, ['rate'])]
)
def test_a_rate_far_from_the_usual_one_is_found(tmp_path, interval, kinds):
    path = write(tmp_path / 'bag', pressures(interval * np.arange(50)))
    assert [kind for kind, _ in found(path)] == kinds


def test_stamps_that_run_backward_or_repeat_are_found(tmp_path):
    stamps = [0, 1, 2, 3, 2.5, 4, 5, 5, 5, 6]
    path = write(tmp_path / 'bag', pressures(stamps), log=lambda n, stamp: START + n * SECOND)
    check = check_bag(path)
    assert (check.topics[0].backward, check.topics[0].duplicates) == (1, 2)
    assert [finding.text for finding in check.findings] == [
        'has 1 stamps earlier than the one before; expected none',
        'has 2 stamps equal to the one before; expected none',
    ]


@pytest.mark.parametrize(('shift_s', 'kinds'), [(2, []), (7, ['stamp']), (-7, ['stamp'])])
def test_log_times_far_from_the_stamps_are_found(tmp_path, shift_s, kinds):
    path = write(
        tmp_path / 'bag', pressures(range(20)), log=lambda n, stamp: stamp + shift_s * SECOND
    )
    assert [kind for kind, _ in found(path)] == kinds
    assert check_bag(path).topics[0].lag_s == (shift_s, shift_s)


def test_a_sweep_of_the_sonar_is_logged_when_it_is_done_and_stamped_when_it_began(tmp_path):
    for lag_s, kinds in ((10, []), (16, ['stamp']), (-6, ['stamp'])):
        sweeps = [
            RangeSample(START + 10 * n * SECOND, 'opening_height', 60.0, 0.5, 1.0, 200.0)
            for n in range(20)
        ]
        path = write(
            tmp_path / str(lag_s), sweeps, log=lambda n, stamp, s=lag_s: stamp + s * SECOND
        )
        assert [kind for kind, _ in found(path)] == kinds


def write_mcap(path, topic, type_name, entries, qos, **options):
    with path.open('wb') as stream:
        writer = Writer(stream, **options)
        writer.start('ros2', 'test')
        schema = writer.register_schema(
            type_name, 'ros2msg', message_definition(type_name).encode()
        )
        channel = writer.register_channel(topic, 'cdr', schema, {'offered_qos_profiles': qos})
        for stamp, data in entries:
            writer.add_message(channel, stamp, data, stamp)
        writer.finish()
    return path


def entries(count=10):
    samples = pressures(range(count))
    return [(sample.stamp, serialize(sample_message(sample)[1])) for sample in samples]


def test_best_effort_on_a_topic_of_the_project_is_found(tmp_path):
    qos = project_profile(False)._replace(reliability=QosReliability.BEST_EFFORT)
    name = 'sensor_msgs/msg/FluidPressure'
    path = write_mcap(tmp_path / 'x.mcap', PRESSURE, name, entries(), dump_profiles([qos]))
    assert 'best effort' in text(path)
    other = write_mcap(tmp_path / 'y.mcap', '/lab/x', name, entries(), dump_profiles([qos]))
    assert found(other) == []


def test_a_latched_topic_offered_volatile_is_found(tmp_path):
    topic, message = estimate_message(np.zeros(12))
    data = serialize(message)
    for durability, kinds in (
        (QosDurability.TRANSIENT_LOCAL, []),
        (QosDurability.VOLATILE, ['qos']),
    ):
        qos = project_profile(True)._replace(durability=durability)
        path = write_mcap(
            tmp_path / f'{durability.name}.mcap',
            absolute(topic),
            message.__msgtype__,
            [(START, data)],
            dump_profiles([qos]),
        )
        assert [kind for kind, _ in found(path)] == kinds


def test_no_qos_in_the_bag_is_no_finding(tmp_path):
    path = write_mcap(tmp_path / 'x.mcap', PRESSURE, 'sensor_msgs/msg/FluidPressure', entries(), '')
    assert found(path) == []
    assert check_bag(path).topics[0].qos == ''


def test_a_wrong_type_is_found(tmp_path):
    path = write_mcap(
        tmp_path / 'x.mcap', '/trawl/door/spread', 'sensor_msgs/msg/FluidPressure', entries(), ''
    )
    assert text(path) == ('has type sensor_msgs/msg/FluidPressure; expected sensor_msgs/msg/Range')


def test_a_file_without_index_is_found(tmp_path):
    path = write_mcap(
        tmp_path / 'x.mcap',
        PRESSURE,
        'sensor_msgs/msg/FluidPressure',
        entries(),
        '',
        index_types=IndexType.NONE,
    )
    assert text(path) == 'x.mcap has no usable index; run `trawl bag repair`'


def test_a_chunk_that_fails_its_checksum_is_found(bag_path, mcap_path):
    with mcap_path.open('rb') as stream:
        index = make_reader(stream).get_summary().chunk_indexes[2]
    whole = bytearray(mcap_path.read_bytes())
    whole[index.chunk_start_offset + index.chunk_length // 2] ^= 0xFF
    mcap_path.write_bytes(whole)
    check = check_bag(bag_path)
    assert check.damaged_chunks == 1
    assert check.count == 480
    kinds = [finding.kind for finding in check.findings]
    assert kinds.count('crc') == 1
    assert any('480 of 600 messages' in finding.text for finding in check.findings)


def test_a_file_cut_short_is_found(bag_path, mcap_path):
    whole = mcap_path.read_bytes()
    mcap_path.write_bytes(whole[: len(whole) // 2])
    check = check_bag(bag_path)
    assert 0 < check.count < 600
    kinds = {finding.kind for finding in check.findings}
    assert {'content', 'index'} <= kinds


@pytest.mark.parametrize(
    ('change', 'words'),
    [
        (lambda told: told['topics_with_message_count'][0].update(message_count=7), 'states 7'),
        (lambda told: told.pop('storage_identifier'), 'storage_identifier'),
        (lambda told: told['relative_file_paths'].append('more.mcap'), 'names more.mcap'),
    ],
)
def test_metadata_that_are_wrong_are_found_and_the_rest_is_told(bag_path, change, words):
    path = bag_path / 'metadata.yaml'
    data = yaml.safe_load(path.read_text())
    change(data['rosbag2_bagfile_information'])
    path.write_text(yaml.safe_dump(data))
    check = check_bag(bag_path)
    assert check.count == 600
    assert words in check.findings[0].text


def test_a_bag_without_messages_is_not_sound(tmp_path):
    BagWriter(tmp_path / 'bag').close()
    assert found(tmp_path / 'bag') == [('content', '')]


def test_no_bag_is_an_error(tmp_path):
    with pytest.raises(BagError, match='no such bag'):
        check_bag(tmp_path / 'none')


def test_topics_of_others_are_told_without_being_judged(tmp_path):
    _, message = sample_message(RangeSample(START, 'spread', 1.0, 0.0, 0.0, 2.0))
    with BagWriter(tmp_path / 'bag') as bag:
        for stamp in (0, 1, 2, 3, 900):
            bag.write('/lab/range', message.__msgtype__, serialize(message), START + stamp * SECOND)
    check = check_bag(tmp_path / 'bag')
    assert check.findings == ()
    (seen,) = check.topics
    assert (seen.group, seen.duplicates, seen.longest_gap_s) == ('', 4, 897.0)
    assert seen.lag_s == (0.0, 900.0)
