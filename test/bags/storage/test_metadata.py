"""``metadata.yaml`` has every key that rosbag2 reads, and the QoS of each topic in either form."""

import copy

import pytest
import yaml
from mcap.reader import make_reader
from rosbags.interfaces import QosReliability

from trawl_ros.bags.reader import Bag
from trawl_ros.bags.storage.metadata_faults import lacking
from trawl_ros.bags.storage.qos import dump_profiles, parse_profiles, project_profile
from trawl_ros.bags.storage.stored import describe
from trawl_ros.bags.writer import BagWriter
from trawl_ros.core.errors import BagError


def metadata(path):
    return yaml.safe_load((path / 'metadata.yaml').read_text())['rosbag2_bagfile_information']


def test_rosbag2_misses_nothing_in_the_metadata(sound_bag, tmp_path):
    BagWriter(tmp_path / 'empty').close()
    for path in (sound_bag, tmp_path / 'empty'):
        assert lacking(metadata(path)) == []
        assert list(metadata(path)) == list(ORDER)


# In the order in which rosbag2 encodes them (rosbag2_storage, yaml.hpp, convert<BagMetadata>).
ORDER = (
    'version',
    'storage_identifier',
    'duration',
    'starting_time',
    'message_count',
    'topics_with_message_count',
    'compression_format',
    'compression_mode',
    'relative_file_paths',
    'files',
    'custom_data',
    'ros_distro',
)


def every_place(node, path=()):
    """Give the keys that lead to each value of nested maps and lists."""
    items = node.items() if isinstance(node, dict) else enumerate(node)
    for key, value in items:
        yield (*path, key)
        if isinstance(value, (dict, list)):
            yield from every_place(value, (*path, key))


def test_whatever_is_taken_out_of_the_metadata_would_be_missed(sound_bag):
    whole = metadata(sound_bag)
    for topic in whole['topics_with_message_count']:
        said = topic['topic_metadata']
        said['offered_qos_profiles'] = yaml.safe_load(said['offered_qos_profiles'])
    places = [place for place in every_place(whole) if isinstance(place[-1], str)]
    assert len(places) > 60
    for *path, key in places:
        node = changed = copy.deepcopy(whole)
        for step in path:
            node = node[step]
        del node[key]
        for topic in changed.get('topics_with_message_count', ()):
            said = topic.get('topic_metadata', {})
            if 'offered_qos_profiles' in said:
                said['offered_qos_profiles'] = yaml.safe_dump(said['offered_qos_profiles'])
        assert any(key in name for name in lacking(changed)), (*path, key)


def test_metadata_and_channels_state_the_same_qos(sound_bag):
    # rosbags joins them by that, and gives nothing where they differ.
    stated = {
        topic['topic_metadata']['name']: topic['topic_metadata']['offered_qos_profiles']
        for topic in metadata(sound_bag)['topics_with_message_count']
    }
    with (sound_bag / 'trial_0.mcap').open('rb') as stream:
        channels = make_reader(stream).get_summary().channels.values()
    assert {c.topic: c.metadata['offered_qos_profiles'] for c in channels} == stated


def test_what_is_declared_of_a_topic_stands(tmp_path, messages):
    topic, kind, data, stamp = messages[0]
    best_effort = project_profile(True)._replace(reliability=QosReliability.BEST_EFFORT)
    with BagWriter(tmp_path / 'bag') as bag:
        bag.declare(topic, describe(kind, dump_profiles([best_effort])))
        bag.write(topic, kind, data, stamp)
        with pytest.raises(BagError, match=f'{topic}.* definition'):
            bag.declare(topic, describe(kind, ''))
    assert Bag(tmp_path / 'bag').offered() == {topic: (best_effort,)}


@pytest.mark.parametrize(
    'offered',
    ['[{history: 1}]', '{', '[3]', [{'history': 'keep_last'}], 'x' * 70_000, 3],
    ids=['lacks policies', 'not YAML', 'no map', 'lacks policies (list)', 'too long', 'number'],
)
def test_profiles_that_make_no_sense_are_refused(offered):
    with pytest.raises(BagError, match='/x: offered_qos_profiles cannot be understood'):
        parse_profiles('/x', offered)


def test_both_forms_of_profiles_are_read():
    latched = project_profile(True)
    words = yaml.safe_load(dump_profiles([latched]))
    words[0] |= {
        'history': 'keep_last',
        'reliability': 'reliable',
        'durability': 'transient_local',
        'liveliness': 'automatic',
    }
    assert parse_profiles('/x', words) == (latched,)
    assert parse_profiles('/x', yaml.safe_dump(words)) == (latched,)
    assert parse_profiles('/x', dump_profiles([latched, latched])) == (latched, latched)
    assert parse_profiles('/x', '') == ()
