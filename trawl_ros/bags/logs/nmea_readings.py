"""Conversion of NMEA 0183 sentences into samples without their times."""

import math
import re
from collections.abc import Callable
from typing import Any

import numpy as np
from pynmeagps.nmeatypes_get import NMEA_PAYLOADS_GET

from trawl_ros.bags.logs.nmea_mapping import NmeaMapping, NmeaTopic
from trawl_ros.core.compass import compass_yaw, course_velocity
from trawl_ros.core.units import UNITS
from trawl_ros.records.possible import impossible_compass
from trawl_ros.records.samples import FixSample, HeadingSample, RangeSample, Sample, VelocitySample

KNOT, KM_H = UNITS['kn'].size, UNITS['km/h'].size
FOOT, FATHOM = UNITS['ft'].size, UNITS['fathom'].size

SampleAt = Callable[[int], Sample]
"""Gives the sample for a stamp (ns)."""


_UNITS = {'cogtUnit': 'T', 'cogmUnit': 'M', 'sognUnit': 'N', 'sogkUnit': 'K', 'hgdTu': 'T',
          'hgdMu': 'M', 'spdNu': 'N', 'spdKu': 'K', 'headingTu': 'T', 'depthfu': 'F',
          'depthmu': 'M', 'depthfathu': 'F'}  # fmt: skip
"""Letters behind numbers, by the library's names of their fields."""
_POSITION = re.compile(r'\d+(?:\.\d*)?')


class NoReading(ValueError):
    """Sentence without a valid reading, by its status or by empty fields."""


def misread(sentence: Any) -> str | None:
    """Say in what the fields of a parsed sentence are not those of its kind; None where they are.

    The library takes any number of fields, of any content where it expects letters, and minutes
    of 60 and more.
    """
    names = list(NMEA_PAYLOADS_GET.get(sentence.msgID, ()))
    fields = [text.strip() for text in sentence.payload]
    if 'group' in names or not names:
        return None
    if len(fields) > len(names):
        # As where a decimal comma made two of one.
        return f'{len(fields)} fields, expected {len(names)} at most'
    for name, text in zip(names, fields, strict=False):
        if text and name in _UNITS and text.upper() != _UNITS[name]:
            return f'a field that should be {_UNITS[name]} is not'
        if name in ('lat', 'lon') and text:
            whole, _, _ = text.partition('.')
            if not _POSITION.fullmatch(text) or int(whole[-2:] or 0) >= 60:
                return 'a position that is not degrees and minutes'
    return None


def sample_of(topic: str, sentence: Any, entry: NmeaTopic, mapping: NmeaMapping) -> SampleAt:
    """Convert a parsed sentence into the sample of a topic.

    Parameters
    ----------
    topic
        Relative name.
    sentence
        As `pynmeagps` gives it.
    entry, mapping
        Entry of the mapping for it, and the whole mapping.

    Raises
    ------
    NoReading
        If it has none.
    """
    std = entry.std.si() if entry.std else 0.0
    match topic:
        case 'vessel/fix':
            return _fix(sentence, std)
        case 'vessel/velocity_ground':
            return _over_ground(sentence)
        case 'vessel/velocity_water':
            return _through_water(sentence)
        case 'vessel/heading':
            return _heading(sentence, std)
    limits = [limit.si() for limit in (entry.min_range, entry.max_range) if limit]
    below_keel = _below_keel(sentence, mapping)
    return lambda stamp: RangeSample(stamp, 'depth', below_keel, std, *limits)


def _fix(sentence: Any, std: float) -> SampleAt:
    match sentence.msgID:
        case 'GGA':
            _valid(sentence.quality not in ('', 0))
        case 'GNS':
            _valid(bool(set(sentence.posMode) - {'N'}))
        case _:
            _valid(sentence.status == 'A')
    if sentence.NS not in ('N', 'S') or sentence.EW not in ('E', 'W'):
        raise NoReading('hemisphere other than N or S and E or W')
    latitude, longitude = _number(sentence.lat), _number(sentence.lon)
    return lambda stamp: FixSample(stamp, latitude, longitude, std)


def _over_ground(sentence: Any) -> SampleAt:
    if sentence.msgID == 'RMC':
        _valid(sentence.status == 'A')
        speed, course = _number(sentence.spd) * KNOT, sentence.cog
    else:
        _valid(getattr(sentence, 'posMode', '') != 'N')
        speed, course = _speed(sentence.sogn, sentence.sogk), sentence.cogt
    # A receiver that stands still gives no course.
    direction = 0.0 if speed == 0.0 and course == '' else math.radians(_compass(course))
    velocity = course_velocity(speed, direction)
    return lambda stamp: VelocitySample(stamp, 'ground', velocity, math.nan)


def _through_water(sentence: Any) -> SampleAt:
    to_starboard = 0.0
    if sentence.msgID == 'VBW':
        _valid(sentence.waterspdstatus == 'A')
        forward = _number(sentence.longwaterspd) * KNOT
        if sentence.transwaterspd != '':
            to_starboard = _number(sentence.transwaterspd) * KNOT
    else:
        forward = _speed(sentence.spdN, sentence.spdK)
    velocity = np.array([forward, -to_starboard, 0.0])
    return lambda stamp: VelocitySample(stamp, 'water', velocity, math.nan)


def _heading(sentence: Any, std: float) -> SampleAt:
    if sentence.msgID == 'THS':
        _valid(sentence.mi != 'V')
        true = _compass(sentence.headt)
    else:
        true = _compass(sentence.headingT)
    return lambda stamp: HeadingSample(stamp, compass_yaw(math.radians(true)), std)


def _below_keel(sentence: Any, mapping: NmeaMapping) -> float:
    keel = mapping.keel_depth.si()
    if sentence.msgID == 'DPT':
        # Below zero, the offset is how far the keel is below the transducer; above, the waterline.
        offset = getattr(sentence, 'offset', '')
        depth_of_keel = -offset if isinstance(offset, float) and offset < 0 else keel
        return _number(sentence.depth) - depth_of_keel
    for value, unit in (
        (sentence.depthm, 1.0),
        (sentence.depthf, FOOT),
        (sentence.depthfath, FATHOM),
    ):
        if value != '':
            return _number(value) * unit - keel
    raise NoReading


def _speed(knots: Any, km_h: Any) -> float:
    return _number(knots) * KNOT if knots != '' else _number(km_h) * KM_H


def _number(value: Any) -> float:
    if not isinstance(value, int | float) or not math.isfinite(value):
        raise NoReading
    return float(value)


def _compass(value: Any) -> float:
    degrees = _number(value)
    if why := impossible_compass(degrees):
        raise NoReading(why)
    return degrees


def _valid(valid: bool) -> None:
    if not valid:
        raise NoReading
