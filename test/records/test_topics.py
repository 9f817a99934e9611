"""The table of topics is consistent in itself and with the message definitions."""

import numpy as np
import pytest

from trawl_ros.messages.cdr import STORE
from trawl_ros.records.channels import CHANNELS
from trawl_ros.records.registry import with_numbers
from trawl_ros.records.rights import enclaves
from trawl_ros.records.topics import (
    CLOCK,
    COMMANDS,
    ESTIMATES,
    INSTRUMENTS,
    STATIC_TRANSFORMS,
    TETHER,
    TOPICS,
    TRANSFORMS,
    TRUTH,
    TWINS,
    absolute,
    find_topic,
)


def test_no_name_stands_twice():
    rows = (*TRUTH, *INSTRUMENTS, *TWINS, *TETHER, *ESTIMATES, *COMMANDS)
    assert len(TOPICS) == len(rows) + len((CLOCK, TRANSFORMS, STATIC_TRANSFORMS))


def test_types_are_known():
    assert all(topic.type in STORE.types for topic in TOPICS.values())


def test_a_frame_is_stated_where_the_type_has_one():
    for topic in (*TRUTH, *INSTRUMENTS, *COMMANDS):
        has_header = any(name == 'header' for name, _ in STORE.fielddefs[topic.type][1])
        assert bool(topic.frame) == has_header, topic.name


@pytest.mark.parametrize('row', INSTRUMENTS, ids=lambda row: row.name)
def test_a_row_is_that_of_its_samples_and_channels(row):
    assert row.blank.topic == row.name
    channels = [field.channel for field in row.fields if field.channel]
    assert all(channel.topic == row.name for channel in channels)
    assert all(CHANNELS[channel.name] is channel for channel in channels)
    for field in row.fields:
        assert np.isnan(field.get(row.blank)) or field.get(row.blank) == 0.0
        assert field.get(with_numbers(row.blank, {field: 1.5})) == 1.5


def test_rows_name_nodes_that_there_are():
    named = {name for row in TOPICS.values() for name in (*row.published_by, *row.heard_by)}
    assert named <= set(enclaves())
    assert all(row.published_by for row in (*TRUTH, *INSTRUMENTS))


def test_names_get_the_namespace():
    assert absolute('truth/winch') == '/trawl/truth/winch'
    assert absolute('truth/winch', '/ship/a/') == '/ship/a/truth/winch'
    assert absolute('truth/winch', '') == '/truth/winch'
    assert absolute('/clock') == '/clock'


def test_topics_are_found_under_either_name():
    assert find_topic('/trawl/truth/winch') is TOPICS['truth/winch']
    assert find_topic('truth/winch') is TOPICS['truth/winch']
    assert find_topic('/diagnostics') is TOPICS['/diagnostics']
    assert find_topic('/ship/truth/winch', 'ship') is TOPICS['truth/winch']
    assert find_topic('/other/truth/winch') is None
    assert find_topic('/trawl/somebody/else') is None
