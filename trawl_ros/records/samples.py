"""Samples of instruments: one record per kind of reading, stamped when it was sampled.

Stamps are integer nanoseconds; units are SI; a ``std`` is the sensor's *stated* noise.
"""

from dataclasses import dataclass

from trawl_ros.core.arrays import ByteArray, FloatArray


@dataclass(frozen=True)
class WinchSample:
    """Winch sample: counter (m), pay-out speed (m/s) and load cell (N) of both, port first."""

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


@dataclass(frozen=True)
class AttitudeSample:
    """Inclinometer sample: pitch (nose down positive) and roll (top to starboard), rad."""

    stamp: int
    side: str
    pitch: float
    roll: float
    std: float


@dataclass(frozen=True)
class RangeSample:
    """Range sample, m.

    ``what`` is 'spread', 'opening_height', 'opening_width', 'bottom' (from the headrope down
    to the seabed), 'depth' (from the keel down to it) or 'school' (from the keel down to fish).
    """

    stamp: int
    what: str
    distance: float
    std: float
    min_range: float
    max_range: float


@dataclass(frozen=True)
class VelocitySample:
    """Velocity sample (3,), m/s: ``over`` 'water' in frame vessel, ``over`` 'ground' in map."""

    stamp: int
    over: str
    velocity: FloatArray
    yaw_rate: float


@dataclass(frozen=True)
class HeadingSample:
    """Heading sample as ENU yaw, rad."""

    stamp: int
    heading: float
    std: float


@dataclass(frozen=True)
class FixSample:
    """Position sample: latitude and longitude in degrees (WGS 84), std in m."""

    stamp: int
    latitude: float
    longitude: float
    std: float


@dataclass(frozen=True)
class SonarImageSample:
    """Image sample of one sweep of the trawl sonar, as on its screen, stamped at the first ping.

    ``image`` (beams, cells) uint8: row i is a beam, column j the echo from (j + ½) / cells of
    the range. At which angles and how far, the scan of the same stamp says.
    """

    stamp: int
    image: ByteArray


@dataclass(frozen=True)
class SonarScanSample:
    """First echo per beam of a sweep: ``ranges`` (beams,) m, infinite without one, and
    ``intensities`` (beams,), 0 to 255.

    Beam i looks at ``angle_min`` + i ``angle_increment`` (rad about z of frame ``sonar``, 0 down,
    to port positive); ``sweep_s`` is how long the sweep took.
    """

    stamp: int
    ranges: FloatArray
    intensities: FloatArray
    angle_min: float
    angle_increment: float
    min_range: float
    max_range: float
    sweep_s: float


@dataclass(frozen=True)
class SonarPointsSample:
    """Echoes of a sweep: ``points`` (n, 4), position in ``map`` (m) and intensity, 0 to 255."""

    stamp: int
    points: FloatArray


@dataclass(frozen=True)
class SchoolsSample:
    """Schools detected by the fish sonar: ``positions`` (n, 3) in frame ``vessel``, m."""

    stamp: int
    positions: FloatArray


Sample = (
    WinchSample
    | PressureSample
    | AttitudeSample
    | RangeSample
    | VelocitySample
    | HeadingSample
    | FixSample
    | SonarImageSample
    | SonarScanSample
    | SonarPointsSample
    | SchoolsSample
)
