# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Samples of instruments, and the registry of their topics: one record and one row per sensor.

Stamps are integer nanoseconds; units are SI; a ``std`` is the sensor's *stated* noise. Codec,
channels, limits, rights and tables all come from `INSTRUMENTS`.
"""

import math
from dataclasses import dataclass, field, replace
from typing import ClassVar

import numpy as np

from trawl_ros.core.arrays import ByteArray, FloatArray
from trawl_ros.records.registry import (
    DOOR_FRAMES,
    DOOR_SPREAD,
    ECHO_SOUNDER,
    MAP,
    SLANT_RANGE,
    SONAR,
    SONAR_WIDTH,
    VESSEL,
    Channel,
    Field,
    Sensor,
)
from trawl_ros.records.truth import SIDES


@dataclass(frozen=True)
class WinchSample:
    """Winch sample: counter (m), pay-out speed (m/s) and load cell (N) of both, port first."""

    topic: ClassVar = 'winch/joint_states'
    stamp: int
    lengths: tuple[float, float]
    speeds: tuple[float, float]
    tensions: tuple[float, float]


@dataclass(frozen=True)
class PressureSample:
    """Pressure sample (Pa, absolute); ``place`` is 'port', 'starboard' (the doors) or 'sonar'."""

    stamp: int
    place: str
    pressure: float
    std: float

    @property
    def topic(self) -> str:
        """Relative name of its topic."""
        return 'sonar/pressure' if self.place == 'sonar' else f'door/{self.place}/pressure'


@dataclass(frozen=True)
class AttitudeSample:
    """Inclinometer sample: pitch (nose down positive) and roll (top to starboard), rad."""

    stamp: int
    side: str
    pitch: float
    roll: float
    std: float

    @property
    def topic(self) -> str:
        """Relative name of its topic."""
        return f'door/{self.side}/attitude'


@dataclass(frozen=True)
class WarpAngleSample:
    """Angles of a warp at its towing block, rad.

    ``divergence`` is positive outward from the ship's course, ``declination`` positive downward.
    """

    stamp: int
    side: str
    divergence: float
    declination: float

    @property
    def topic(self) -> str:
        """Relative name of its topic."""
        return f'winch/{self.side}/warp_angles'


@dataclass(frozen=True)
class RangeSample:
    """Range sample, m.

    ``what`` is 'spread', 'opening_height', 'opening_width', 'bottom' (from the headrope to the
    seabed), 'depth' (from the keel to the seabed), 'school' (from the keel to fish), 'port_slant'
    or 'starboard_slant' (from the ship to the door).
    """

    stamp: int
    what: str
    distance: float
    std: float
    min_range: float
    max_range: float

    @property
    def topic(self) -> str:
        """Relative name of its topic."""
        return RANGES[self.what]


@dataclass(frozen=True)
class VelocitySample:
    """Velocity sample (3,), m/s: ``over`` 'water' in frame vessel, ``over`` 'ground' in map.

    ``stated`` is the stated noise of velocity (m/s) and rate of turn (rad/s), 0 where unknown. The
    message without covariance does not carry it, so samples are compared without it.
    """

    stamp: int
    over: str
    velocity: FloatArray
    yaw_rate: float
    stated: tuple[float, float] = field(default=(0.0, 0.0), compare=False)

    @property
    def topic(self) -> str:
        """Relative name of its topic."""
        return f'vessel/velocity_{self.over}'


@dataclass(frozen=True)
class HeadingSample:
    """Heading sample as ENU yaw, rad."""

    topic: ClassVar = 'vessel/heading'
    stamp: int
    heading: float
    std: float


@dataclass(frozen=True)
class FixSample:
    """Position sample: latitude and longitude in degrees (WGS 84), std in m."""

    topic: ClassVar = 'vessel/fix'
    stamp: int
    latitude: float
    longitude: float
    std: float


@dataclass(frozen=True)
class SonarImageSample:
    """Image of one sweep of the trawl sonar, as on its screen, stamped at the first ping.

    ``image`` (beams, cells) is uint8: row i is a beam, and column j the echo from (j + ½) / cells
    of the range. The scan with the same stamp gives angles and range.
    """

    topic: ClassVar = 'sonar/image'
    stamp: int
    image: ByteArray


@dataclass(frozen=True)
class SonarScanSample:
    """First echo of each beam of a sweep.

    ``ranges`` (beams,), in m, are infinite without an echo. ``intensities`` (beams,) are from 0 to
    255.

    Beam i looks at ``angle_min`` + i ``angle_increment`` (rad about z of frame ``sonar``, 0 down,
    to port positive); ``sweep_s`` is how long the sweep took. With ``stamped_at_end`` the stamp is
    not that of the first ping, and pings have no times of their own.
    """

    topic: ClassVar = 'sonar/scan'
    stamp: int
    ranges: FloatArray
    intensities: FloatArray
    angle_min: float
    angle_increment: float
    min_range: float
    max_range: float
    sweep_s: float
    stamped_at_end: bool = field(default=False, compare=False)


@dataclass(frozen=True)
class SonarPointsSample:
    """Echoes of a sweep: ``points`` (n, 4), position in ``map`` (m) and intensity, 0 to 255."""

    topic: ClassVar = 'sonar/points'
    stamp: int
    points: FloatArray


@dataclass(frozen=True)
class SchoolsSample:
    """Schools detected by the fish sonar: ``positions`` (n, 3) in frame ``vessel``, m."""

    topic: ClassVar = 'vessel/fish_sonar'
    stamp: int
    positions: FloatArray


NumberSample = (
    WinchSample
    | PressureSample
    | AttitudeSample
    | WarpAngleSample
    | RangeSample
    | VelocitySample
    | HeadingSample
    | FixSample
)
"""Samples of numbers, each a field of its row."""

PictureSample = SonarImageSample | SonarScanSample | SonarPointsSample | SchoolsSample
"""Samples of images and clouds."""

Sample = NumberSample | PictureSample

RANGES = {
    'spread': 'door/spread',
    'opening_height': 'sonar/opening_height',
    'opening_width': 'sonar/opening_width',
    'bottom': 'sonar/bottom',
    'depth': 'vessel/echo_sounder/depth',
    'school': 'vessel/echo_sounder/school',
    **{f'{side}_slant': f'door/{side}/slant_range' for side in SIDES},
}
"""Topic of each distance, by `RangeSample.what`."""

PICTURES = ('sonar/image', 'sonar/scan', 'sonar/points')
"""Instrument topics that take most of the space in a bag."""

ACOUSTIC_SILENCE_S = 300.0
"""Longest silence (s) of a working acoustic net sensor.

Those of a survey were silent up to 291 s in a haul (public repository
afsc-gap-products/trawlmetrics, vessel 94, 2022).
"""

_DEGREE = math.pi / 180.0
_MAX_DEPTH_M = 12_000.0
_MAX_SPEED_M_S = 60.0
_NONE = math.nan

_IDENTIFIERS = ('identification_node', 'discrepancy_node')
_READERS = (*_IDENTIFIERS, 'nmea_out', 'view_node')
"""Nodes that read what sentences report and what boards are identified from."""


def _winch(side: str, index: int) -> tuple[Field, ...]:
    topic = 'winch/joint_states'
    length = Channel(
        f'{side}_length', topic, 'm', 1.0, 6000.0, 0.1, 0.5, 0.002, 1.0, 4.0,
        required=True, per_state=0.6,
    )  # fmt: skip
    tension = Channel(
        f'{side}_tension', topic, 'N', -5e3, 2e6, 500.0, 200.0, 0.01, 1.0, 4.0,
        required=True, lively=True, settles=True,
    )  # fmt: skip
    return (
        Field(
            length.name, 'lengths', index, 'length', low=-100.0, high=_MAX_DEPTH_M, unit='m',
            channel=length, on_course=True,
        ),
        Field(f'{side}_speed', 'speeds', index, 'speed'),
        # Below 0 is the zero error of a load cell.
        Field(
            tension.name, 'tensions', index, 'force', low=-5e4, high=1e7, unit='N',
            channel=tension, on_course=True,
        ),
    )  # fmt: skip


def _pressure(place: str, channel: str, min_rate: float, delay: float) -> Sensor[PressureSample]:
    name = 'sonar/pressure' if place == 'sonar' else f'door/{place}/pressure'
    depth = Channel(
        channel, name, 'm', -5.0, 3000.0, 0.3, 0.5, 0.005, min_rate, delay,
        required=True, lively=True, settles=True,
    )  # fmt: skip
    # Absolute pressure is more even in thin air; gauge pressure begins at 0.
    pressure = Field(
        'pressure', 'pressure', quantity='pressure', low=5e3, high=1.3e8, unit='Pa',
        channel=depth, on_course=True,
    )  # fmt: skip
    where = "headrope's centre" if place == 'sonar' else f'{place} door'
    return Sensor(
        name, 'sensor_msgs/msg/FluidPressure', SONAR if place == 'sonar' else DOOR_FRAMES[place],
        1.0, f'Absolute pressure at the {where}, Pa.',
        ('trawl_sonar_node' if place == 'sonar' else 'door_sensor_node', 'nmea_in'),
        (*_READERS, 'trial_node'),
        blank=PressureSample(0, place, _NONE, _NONE), fields=(pressure,),
    )  # fmt: skip


def _attitude(side: str) -> Sensor[AttitudeSample]:
    name = f'door/{side}/attitude'

    def angle(what: str, high: float) -> Field:
        channel = Channel(
            f'{side}_{what}', name, 'rad', -1.6, 1.6, 1.0 * _DEGREE, 0.5 * _DEGREE, 0.0,
            0.2, 10.0, required=False, lively=True,
        )  # fmt: skip
        return Field(
            what, what, quantity='angle', at=what, low=-high, high=high, unit='degrees',
            scale=_DEGREE, channel=channel, on_course=True,
        )  # fmt: skip

    return Sensor(
        name, 'sensor_msgs/msg/Imu', DOOR_FRAMES[side], 1.0,
        f'Inclinometer of the {side} door: pitch and roll, yaw unknown, no rates.',
        ('door_sensor_node', 'nmea_in'), _READERS,
        blank=AttitudeSample(0, side, _NONE, _NONE, _NONE),
        fields=(angle('pitch', 90.0), angle('roll', 180.0)),
    )  # fmt: skip


def _warp_angles(side: str) -> Sensor[WarpAngleSample]:
    name = f'winch/{side}/warp_angles'

    def angle(what: str, axis: str) -> Field:
        channel = Channel(
            f'{side}_{what}', name, 'rad', -1.6, 1.6, 0.5 * _DEGREE, 0.5 * _DEGREE, 0.0,
            0.5, 6.0, required=False, lively=True,
        )  # fmt: skip
        return Field(
            what, what, quantity='angle', at=axis, low=-90.0, high=90.0, unit='degrees',
            scale=_DEGREE, channel=channel, on_course=True,
        )  # fmt: skip

    return Sensor(
        name, 'geometry_msgs/msg/Vector3Stamped', VESSEL, 1.0,
        f'Angles of the {side} warp at its block: x = divergence (outward), '
        'y = declination (down), rad.',
        ('winch_node',), (*_IDENTIFIERS, 'view_node'), blank=WarpAngleSample(0, side, _NONE, _NONE),
        fields=(angle('divergence', 'x'), angle('declination', 'y')), errors='warp_angles',
    )  # fmt: skip


def _range(
    what: str, frame: str, rate: float | None, sentence: str, by: tuple[str, ...],
    heard_by: tuple[str, ...], beam_width: float, *, least: float = 0.0, silence: float = 0.0,
    channel: Channel | None = None, on_course: bool = False,
) -> Sensor[RangeSample]:  # fmt: skip
    distance = Field(
        'distance', 'distance', quantity='length', low=least, high=_MAX_DEPTH_M, unit='m',
        channel=channel, series='door_spread' if what == 'spread' else what, on_course=on_course,
    )  # fmt: skip
    return Sensor(
        RANGES[what], 'sensor_msgs/msg/Range', frame, rate, sentence, by, heard_by,
        silence=silence, blank=RangeSample(0, what, _NONE, _NONE, 0.0, 0.0),
        fields=(distance,), beam_width=beam_width,
    )  # fmt: skip


def _slant_range(side: str) -> Sensor[RangeSample]:
    what = f'{side}_slant'
    channel = Channel(
        f'{what}_range', RANGES[what], 'm', 1.0, 6000.0, 1.0, 2.0, 0.005, 0.031, 36.0,
        required=False, lively=True, leap=50.0, usual=False,
    )  # fmt: skip
    row = _range(
        what, SLANT_RANGE, 1.0, f'Acoustic distance from the ship to the {side} door, m.',
        ('door_sensor_node', 'nmea_in'), _READERS, 0.35,
        silence=ACOUSTIC_SILENCE_S, channel=channel, on_course=True,
    )  # fmt: skip
    blank = replace(row.blank, max_range=_MAX_DEPTH_M)
    return replace(row, blank=blank, errors='slant_range')


def _velocity(
    over: str, frame: str, sentence: str, named: tuple[tuple[str, str, Channel | None, str], ...],
    heard_by: tuple[str, ...], rate_of_turn: Channel | None = None,
) -> Sensor[VelocitySample]:  # fmt: skip
    """Return a row; ``named`` holds name, quantity, channel and series of each component."""
    parts = tuple(
        Field(
            name, 'velocity', index, quantity, low=-_MAX_SPEED_M_S, high=_MAX_SPEED_M_S,
            unit='m/s', channel=channel, series=series, on_course=True,
        )
        for index, (name, quantity, channel, series) in enumerate(named)
    )  # fmt: skip
    return Sensor(
        f'vessel/velocity_{over}', 'geometry_msgs/msg/TwistStamped', frame, 1.0, sentence,
        ('vessel_node', 'nmea_in'), (*_READERS, 'autopilot_node', *heard_by),
        blank=VelocitySample(0, over, np.array([_NONE, 0.0, 0.0]), _NONE),
        fields=(*parts, Field('yaw_rate', 'yaw_rate', channel=rate_of_turn)),
    )  # fmt: skip


def _witness(name: str, topic: str, unit: str, limit: float, noise: float) -> Channel:
    """Return a channel that describes the ship's motion and is not part of the fit."""
    return Channel(
        name, topic, unit, -limit, limit, noise, 0.0, 0.0, 1.0, 4.0, required=False
    )  # fmt: skip


_SPREAD = Channel(
    'door_spread', 'door/spread', 'm', 1.0, 1000.0, 1.0, 0.5, 0.005, 0.2, 10.0,
    required=True, lively=True, settles=True, per_state=0.6, leap=20.0,
)  # fmt: skip
_SPEED = Channel(
    'speed', 'vessel/velocity_water', 'm/s', -2.0, 12.0, 0.05, 0.01, 0.005, 1.0, 4.0,
    required=True, lively=True,
)  # fmt: skip
# Stamped when a sweep of 16 s begins, sent when it ends, and 16 s pass until the next.
_OPENING = Channel(
    'vertical_opening', 'sonar/opening_height', 'm', 0.5, 300.0, 2.0, 1.0, 0.03, 0.02, 36.0,
    required=False,
)  # fmt: skip
_GROUND = tuple(
    _witness(f'ground_{way}', 'vessel/velocity_ground', 'm/s', 12.0, 0.05)
    for way in ('east', 'north')
)

INSTRUMENTS: tuple[Sensor[Sample], ...] = (
    Sensor(
        'winch/joint_states', 'sensor_msgs/msg/JointState', VESSEL, 10.0,
        'Counter (m), pay-out speed (m/s) and load cell (N) of both winches.',
        ('winch_node', 'nmea_in'), (*_READERS, 'autotrawl_node', 'trial_node', 'set_points'),
        blank=WinchSample(0, (_NONE, _NONE), (_NONE, _NONE), (_NONE, _NONE)),
        fields=(*_winch('port', 0), *_winch('starboard', 1)), partial=True,
    ),
    _pressure('port', 'port_door_depth', 0.2, 10.0),
    _pressure('starboard', 'starboard_door_depth', 0.2, 10.0),
    _range(
        'spread', DOOR_SPREAD, 1.0, 'Acoustic distance from door to door, m.',
        ('door_sensor_node', 'nmea_in'), _READERS, 0.35, silence=ACOUSTIC_SILENCE_S,
        channel=_SPREAD, on_course=True,
    ),
    _pressure('sonar', 'net_depth', 0.5, 6.0),
    *(_attitude(side) for side in SIDES),
    _range(
        'opening_height', SONAR, None, "Vertical opening as the sonar's operator reads it, m.",
        ('trawl_sonar_node', 'nmea_in'), (*_READERS, 'trial_node'), 0.02, channel=_OPENING,
    ),
    # The width in the sonar's own plane, far behind the wing tips: no observable of the model.
    _range(
        'opening_width', SONAR_WIDTH, None,
        "Horizontal opening as the sonar's operator reads it, m.",
        ('trawl_sonar_node',), ('view_node',), 0.02,
    ),
    Sensor(
        'sonar/image', 'sensor_msgs/msg/Image', SONAR, None,
        'One sweep, mono8: a row per beam, a column per range cell.',
        ('trawl_sonar_node',), ('view_node',),
        blank=SonarImageSample(0, np.zeros((0, 0), np.uint8)),
    ),
    Sensor(
        'sonar/scan', 'sensor_msgs/msg/LaserScan', SONAR, None,
        'First echo per beam with its intensity, for display.',
        ('trawl_sonar_node',), ('view_node',),
        blank=SonarScanSample(0, np.zeros(0), np.zeros(0), 0.0, 0.0, 0.0, 0.0, 0.0),
    ),
    Sensor(
        'sonar/points', 'sensor_msgs/msg/PointCloud2', MAP, None,
        'The echoes of a sweep in map, for display.',
        ('trawl_sonar_node',), ('view_node',), blank=SonarPointsSample(0, np.zeros((0, 4))),
    ),
    *(_warp_angles(side) for side in SIDES),
    *(_slant_range(side) for side in SIDES),
    _range(
        'bottom', SONAR, 1.0, "From the headrope's centre down to the seabed, m.",
        ('trawl_sonar_node', 'nmea_in'), ('nmea_out', 'view_node', 'trial_node'), 0.26,
        silence=ACOUSTIC_SILENCE_S,
    ),
    _velocity(
        'water', VESSEL, 'Speed log: velocity through the water, m/s.',
        (
            ('forward', 'speed', _SPEED, 'speed_water'),
            ('to_port', 'speed', None, 'drift_water'),
            ('up', '', None, ''),
        ),
        ('trial_node',), _witness('yaw_rate', 'vessel/velocity_water', 'rad/s', 1.0, 0.002),
    ),
    # Velocity over ground only tells whether the log sees the water.
    _velocity(
        'ground', MAP, 'GPS: velocity over ground, m/s.',
        (('east', '', _GROUND[0], ''), ('north', '', _GROUND[1], ''), ('up', '', None, '')),
        (),
    ),
    Sensor(
        'vessel/heading', 'sensor_msgs/msg/Imu', VESSEL, 1.0,
        'Heading as ENU yaw; roll and pitch unknown, no rates.',
        ('vessel_node', 'nmea_in'), (*_READERS, 'autopilot_node', 'trial_node'),
        blank=HeadingSample(0, _NONE, _NONE),
        # Heading and rate of turn only tell turning from straight towing.
        fields=(
            Field(
                'heading', 'heading', at='yaw',
                channel=_witness('heading', 'vessel/heading', 'rad', 10.0, 0.02),
            ),
        ),
    ),
    Sensor(
        'vessel/fix', 'sensor_msgs/msg/NavSatFix', VESSEL, 1.0, 'Position, WGS 84.',
        ('vessel_node', 'nmea_in'), ('nmea_out', 'view_node', 'autopilot_node'),
        blank=FixSample(0, _NONE, _NONE, _NONE),
        fields=(
            Field('latitude', 'latitude', low=-90.0, high=90.0, unit='degrees', series='latitude'),
            Field(
                'longitude', 'longitude', low=-180.0, high=180.0, unit='degrees',
                series='longitude',
            ),
        ),
    ),
    _range(
        'depth', ECHO_SOUNDER, 1.0, 'From the keel down to the seabed, m.',
        ('vessel_node', 'nmea_in'),
        ('nmea_out', 'view_node', 'trial_node', 'discrepancy_node'), 0.12,
        least=-100.0, on_course=True,
    ),
    _range(
        'school', ECHO_SOUNDER, 1.0,
        'From the keel down to the uppermost fish under her, m; infinite without any.',
        ('vessel_node',), ('view_node',), 0.12,
    ),
    Sensor(
        'vessel/fish_sonar', 'geometry_msgs/msg/PoseArray', VESSEL, 0.1,
        'Where the fish sonar sees schools.',
        ('vessel_node',), ('view_node', 'autopilot_node'), blank=SchoolsSample(0, np.zeros((0, 3))),
    ),
)  # fmt: skip
"""Registry of the sensors, in the order in which channels are taken from them."""

SENSORS = {row.name: row for row in INSTRUMENTS}
"""Rows by topic."""
