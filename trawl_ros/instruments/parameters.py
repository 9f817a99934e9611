# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Parameters of the instruments as a file has them, checked on load."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any, TypeVar

from pydantic import Field, create_model, model_validator

from trawl_ros.core.errors import InstrumentError, TrawlError
from trawl_ros.core.resources import packaged, share_path
from trawl_ros.core.schema import Record, load_yaml, validated
from trawl_ros.instruments.errors.channel import ErrorModel
from trawl_ros.instruments.errors.random_processes import FalseEchoModel
from trawl_ros.instruments.errors.records import (
    AngleErrors,
    ForceErrors,
    LengthErrors,
    NotNegative,
    PressureErrors,
    Share,
    SoundSpeed,
    SpeedErrors,
    TurnErrors,
    both_or_neither,
)
from trawl_ros.instruments.errors.timing import Sent, Timed
from trawl_ros.instruments.sonar.records import SweepRecord
from trawl_ros.records.registry import Sensor
from trawl_ros.records.samples import Sample
from trawl_ros.records.sensors import INSTRUMENTS

BASE = 'base'


class AngleParameters(AngleErrors, Timed):
    """Sensor of angles, with equal and independent errors."""


class LengthParameters(LengthErrors, Timed):
    """Sensor of lengths, with equal and independent errors."""


class ForceParameters(ForceErrors, Timed):
    """Sensor of forces, with equal and independent errors."""


ByUnit = AngleParameters | LengthParameters | ForceParameters
BY_UNIT: dict[str, type[ByUnit]] = {
    'rad': AngleParameters,
    'm': LengthParameters,
    'N': ForceParameters,
}
"""Errors of sensors that only measure observables, by the unit of their channels."""

GROUPS = {
    'winch_node': 'winch',
    'door_sensor_node': 'door',
    'trawl_sonar_node': 'sonar',
    'vessel_node': 'vessel',
}
"""Keys of the instruments of each node."""

RecordT = TypeVar('RecordT', bound=Record)


def observing(node: str) -> tuple[Sensor[Sample], ...]:
    """Return the sensors of a node that only measure observables."""
    return tuple(row for row in INSTRUMENTS if row.errors and node in row.published_by)


def _with_observing(node: str) -> Callable[[type[RecordT]], type[RecordT]]:
    """Add the errors of the sensors of a node that only measure observables."""
    keys = {
        row.errors: (BY_UNIT[row.fields[0].channel.unit] | None, None)
        for row in observing(node)
        if row.fields[0].channel
    }

    def with_keys(cls: type[RecordT]) -> type[RecordT]:
        # Pydantic's options are keywords like those of the fields, which mypy cannot tell apart.
        model: type[RecordT] = create_model(  # type: ignore[call-overload]  # as said above
            cls.__name__, __base__=cls, __doc__=cls.__doc__, __module__=cls.__module__, **keys
        )
        return model

    return with_keys


@_with_observing('winch_node')
class WinchParameters(Timed):
    """Winches: counter, pay-out speed and load cell; errors of both sides are independent.

    The counting wheel counts stretched wire. Its error is the tension in excess of
    ``calibrated_at_kn``, the tension of its calibration, over ``wire_stiffness_mn``. The load cell
    has friction: it follows the tension only after a change of ``hysteresis_kn``.
    """

    length: LengthErrors
    speed: SpeedErrors
    tension: ForceErrors
    wire_stiffness_mn: Annotated[float, Field(gt=0)] | None = None
    calibrated_at_kn: NotNegative = 0.0
    hysteresis_kn: NotNegative = 0.0


class PressureParameters(PressureErrors, Timed):
    """Pressure sensor."""


class LimitedLength(LengthErrors):
    """Length sensor; outside its limits the reading is infinite (REP-117)."""

    min_range_m: NotNegative
    max_range_m: Annotated[float, Field(gt=0, le=10_000)]

    @model_validator(mode='after')
    def _limits_in_order(self) -> 'LimitedLength':
        if self.min_range_m >= self.max_range_m:
            raise ValueError(
                f'max_range_m: found {self.max_range_m}, expected more than min_range_m, '
                f'which is {self.min_range_m}'
            )
        return self


class RangeParameters(LimitedLength, Timed):
    """Acoustic range sensor.

    It has three kinds of false echoes, each with its share of the readings and its mean number of
    readings in a row (``_run``). Reflections travel a longer path, by ``reflection_m`` on average.
    Ambiguous readings are received in the next period of the ranging and are ``ambiguity_m`` too
    long. Double echoes travel there and back twice.
    """

    reflection_share: Share = 0.0
    reflection_m: NotNegative = 0.0
    reflection_run: Annotated[float, Field(ge=1)] = 1.0
    ambiguity_share: Share = 0.0
    ambiguity_m: NotNegative = 0.0
    ambiguity_run: Annotated[float, Field(ge=1)] = 1.0
    double_share: Share = 0.0
    double_run: Annotated[float, Field(ge=1)] = 1.0

    @model_validator(mode='after')
    def _false_echoes_have_a_size(self) -> 'RangeParameters':
        for kind in ('reflection', 'ambiguity'):
            both_or_neither(**{key: getattr(self, key) for key in (f'{kind}_share', f'{kind}_m')})
        return self

    def model(self) -> ErrorModel:
        """Return the error model in SI units."""
        reflected = FalseEchoModel(
            self.reflection_share, self.reflection_m, ambiguous=False, run=self.reflection_run
        )
        ambiguous = FalseEchoModel(
            self.ambiguity_share, self.ambiguity_m, ambiguous=True, run=self.ambiguity_run
        )
        double = FalseEchoModel(self.double_share, multiple=2.0, run=self.double_run)
        echoes = tuple(model for model in (reflected, ambiguous, double) if model.share > 0)
        return replace(super().model(), false_echoes=echoes)


class VelocityParameters(Timed):
    """Velocity sensor over ground or through the water, with the rate of turn."""

    velocity: SpeedErrors
    yaw_rate: TurnErrors


class SpreadParameters(RangeParameters):
    """Acoustic spread sensor from door to door.

    Travel times are converted with ``assumed_sound_speed_m_s``, whatever the speed of sound in the
    water is. The beam of each door points inward along its normal. There is no reading if the other
    door is more than ``beam_half_angle_deg`` off the beam.
    """

    assumed_sound_speed_m_s: SoundSpeed | None = None
    beam_half_angle_deg: Annotated[float, Field(gt=0, le=180)] = 180.0


@_with_observing('door_sensor_node')
class DoorParameters(Record):
    """Sensors of the doors, the same on both."""

    pressure: PressureParameters
    attitude: AngleParameters
    spread: SpreadParameters


class SweepParameters(SweepRecord, Timed):
    """Sweeps of the trawl sonar, ``rate_hz`` per second; each begins as the last one ends."""

    @model_validator(mode='after')
    def _time_to_listen(self) -> 'SweepParameters':
        needed = self.beams * self.listening_s * self.rate_hz
        if needed > 1 + 1e-9:
            raise ValueError(
                f'rate_hz: found {self.rate_hz:g}, expected at most {self.rate_hz / needed:.3g}: '
                f'each of the {self.beams} pings waits {self.listening_s:.3g} s for echoes from '
                'max_range_m'
            )
        return self


class OpeningParameters(LimitedLength, Sent):
    """Opening as read from each image: errors in addition to those of the image.

    ``stated_std_m`` is the stated error of the reading, including that of the image.
    """


class BottomParameters(RangeParameters):
    """Sounder that points down from the headrope.

    Travel times are converted with ``assumed_sound_speed_m_s``.
    """

    assumed_sound_speed_m_s: SoundSpeed


@_with_observing('trawl_sonar_node')
class SonarParameters(Record):
    """Trawl sonar on the headrope, with the other instruments in its housing."""

    pressure: PressureParameters
    sweep: SweepParameters
    opening_height: OpeningParameters
    opening_width: OpeningParameters
    bottom: BottomParameters


class EchoSounderParameters(Record):
    """Echo sounder under the keel: distances to the seabed and to the nearest fish in its beam.

    Travel times are converted with ``assumed_sound_speed_m_s``; ``beam_width_deg`` is the full
    width of the beam.
    """

    assumed_sound_speed_m_s: SoundSpeed
    beam_width_deg: Annotated[float, Field(gt=0, le=60)]
    depth: RangeParameters
    school: RangeParameters


class FishSonarParameters(Timed):
    """Fish sonar: sweeps over ``sector_deg`` centred on the heading.

    The beam is tilted down by ``beam_tilt_deg`` and is ``beam_width_deg`` high. ``range``,
    ``bearing`` and ``tilt`` are the errors of the position of a school.

    ``fish_target_strength_db`` is that of one fish. Half of the schools with an echo of
    ``half_seen_db`` (for a source of 0 dB) are detected, 73 % with one ``fading_db`` more, and 95 %
    with three ``fading_db`` more.
    """

    assumed_sound_speed_m_s: SoundSpeed
    frequency_khz: Annotated[float, Field(ge=10, le=500)]
    min_range_m: NotNegative
    max_range_m: Annotated[float, Field(gt=0, le=10_000)]
    sector_deg: Annotated[float, Field(gt=0, le=360)]
    beam_tilt_deg: Annotated[float, Field(ge=-10, le=90)]
    beam_width_deg: Annotated[float, Field(gt=0, le=90)]
    fish_target_strength_db: Annotated[float, Field(ge=-80, le=0)]
    half_seen_db: Annotated[float, Field(ge=-300, le=0)]
    fading_db: Annotated[float, Field(gt=0, le=30)]
    range: LengthErrors
    bearing: AngleErrors
    tilt: AngleErrors


@_with_observing('vessel_node')
class VesselParameters(Record):
    """Sensors of the ship, and the datum of ``map``.

    The keel, which carries echo sounder and fish sonar, is ``draught_m`` below the towing blocks.
    """

    datum_lat_deg: Annotated[float, Field(ge=-89, le=89)]
    datum_lon_deg: Annotated[float, Field(ge=-180, le=180)]
    draught_m: Annotated[float, Field(ge=0, le=30)]
    velocity_water: VelocityParameters
    velocity_ground: VelocityParameters
    fix: LengthParameters
    heading: AngleParameters
    echo_sounder: EchoSounderParameters
    fish_sonar: FishSonarParameters


class InstrumentParameters(Record):
    """All instruments of a ship."""

    winch: WinchParameters
    door: DoorParameters
    sonar: SonarParameters
    vessel: VesselParameters


def load_instruments(path: str | Path = 'default') -> InstrumentParameters:
    """Read and check a file of instrument parameters.

    Parameters
    ----------
    path
        A file that ends in ``.yaml``, or the name of a set in the package. A file with the key
        ``base`` names a set of the package and has only the keys that differ from it.

    Returns
    -------
    InstrumentParameters
        Errors and timing of all instruments, each value with its unit in its name.

    Raises
    ------
    InstrumentError
        If the file is missing or a value is wrong; it names file, key, found and expected values.

    Examples
    --------
    >>> import trawl_ros
    >>> trawl_ros.load_instruments().winch.rate_hz
    2.0
    """
    path = packaged(path, 'instruments', InstrumentError)
    data = load_yaml(path, InstrumentError)
    if isinstance(data, dict) and BASE in data:
        base = data.pop(BASE)
        if not isinstance(base, str) or base.endswith(('.yaml', '.yml')):
            raise InstrumentError(
                f'{path}: {BASE}: found {base!r}, expected the name of a set of the package'
            )
        data = _merged(_set_of_package(base), data)
    return validated(InstrumentParameters, data, path, InstrumentError)


def default_instruments_with(
    overrides: dict[str, Any], path: str | Path, error: type[TrawlError], *, prefix: str
) -> InstrumentParameters:
    """Check the default parameters with some of them replaced.

    Parameters
    ----------
    overrides
        Keys that differ, nested as in the file.
    path, prefix
        File and key of the overrides, for the error.
    error
        Class of the error to raise.
    """
    defaults = _set_of_package('default')
    return validated(InstrumentParameters, _merged(defaults, overrides), path, error, prefix=prefix)


def _merged(base: dict[str, Any], overrides: dict[str, Any]) -> dict[str, Any]:
    merged = dict(base)
    for key, value in overrides.items():
        both = isinstance(value, dict) and isinstance(base.get(key), dict)
        merged[key] = _merged(base[key], value) if both else value
    return merged


def _set_of_package(name: str) -> Any:
    try:
        file = share_path('config', 'instruments', f'{name}.yaml')
    except TrawlError as reason:
        raise InstrumentError(str(reason)) from reason
    return load_yaml(file, InstrumentError)
