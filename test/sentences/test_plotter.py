"""Positions of doors and net as a chart plotter hears them."""

import math

import numpy as np
import pytest

from trawl_ros.records.fields import WaterColumn
from trawl_ros.records.samples import (
    HeadingSample,
    PressureSample,
    RangeSample,
    WinchSample,
)
from trawl_ros.sentences.framing import parse_line
from trawl_ros.sentences.plotter import PlotterWriter

WATER = WaterColumn(density_kg_m3=1025.0)
SECOND = 1_000_000_000
START = 1_785_585_600 * SECOND


def samples(stamp: int):
    deep = WATER.pressure
    yield HeadingSample(stamp, np.radians(90.0), 0.01)  # north
    yield RangeSample(stamp, 'spread', 120.0, 1.0, 1.0, 400.0)
    for side in ('port', 'starboard'):
        yield PressureSample(stamp, side, deep(100.0), 1.0)
    yield PressureSample(stamp, 'sonar', deep(110.0), 1.0)


def spoken(texts):
    return {text.strip('$@').split(',')[0] + text.split(',')[1]: text.split(',') for text in texts}


def winch(stamp: int):
    return WinchSample(stamp, (400.0, 400.0), (0.0, 0.0), (1e5, 1e5))


def test_doors_and_net_are_where_straight_warps_have_them():
    writer = PlotterWriter(WATER, 100.0)
    assert [text for one in samples(START) for text in writer.write(one)] == []
    texts = writer.write(winch(START))
    assert len(texts) == 5
    found = spoken(texts)
    astern = math.sqrt(400.0**2 - 100.0**2 - 60.0**2)
    port = found['IITTM01']
    assert float(port[2]) * 1852.0 == pytest.approx(math.hypot(astern, 60.0), abs=1.0)
    # Port is to the left of astern: more than 180 degrees clockwise from the bow.
    assert float(port[3]) == pytest.approx(180.0 + math.degrees(math.atan2(60.0, astern)), abs=0.1)
    assert float(found['IITTM02'][3]) < 180.0
    net = next(text for text in texts if text.startswith('@IITPR'))
    behind = math.sqrt(100.0**2 - 10.0**2 - 60.0**2)
    assert net == f'@IITPR,{astern + behind:.0f},M,180,P,110.0,M'
    assert next(text for text in texts if text.startswith('@IITPT')).split(',')[3] == '180'
    assert all(parse_line(text.encode()) for text in texts if text.startswith('$'))


def test_a_slant_range_replaces_the_warp_and_old_readings_are_not_used():
    writer = PlotterWriter(WATER, 100.0)
    for one in samples(START):
        writer.write(one)
    writer.write(RangeSample(START, 'port_slant', 380.0, 1.0, 0.0, 6000.0))
    found = spoken(writer.write(winch(START)))
    assert float(found['IITTM01'][2]) < float(found['IITTM02'][2])
    assert writer.write(winch(START + 200 * SECOND)) == []
