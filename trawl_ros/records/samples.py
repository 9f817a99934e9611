# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Samples of instruments: a record per kind of reading.

Stamps are integer nanoseconds; units are SI; a ``std`` is the sensor's *stated* noise. The rows of
their topics are in `trawl_ros.records.sensors`.
"""

from dataclasses import dataclass, field
from typing import ClassVar

from trawl_ros.core.arrays import ByteArray, FloatArray
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
