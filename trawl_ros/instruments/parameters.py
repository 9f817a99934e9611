"""Parameters of the instruments as a file has them, checked on load."""

from pathlib import Path
from typing import Annotated, Any, ClassVar

import numpy as np
from pydantic import Field, model_validator

from trawl_ros.errors import InstrumentError, TrawlError
from trawl_ros.instruments.channel import ErrorModel
from trawl_ros.schema import Record, load_yaml, validated
from trawl_ros.share import share_path

Rate = Annotated[float, Field(gt=0, le=100)]
NotNegative = Annotated[float, Field(ge=0)]
Seconds = Annotated[float, Field(ge=0, le=100_000)]


class Errors(Record):
    """Errors of a channel in a unit of its own; each kind is a standard deviation but one.

    Keys end in the unit: ``noise_m`` is drawn per sample, ``correlated_m`` belongs to a
    first-order process with ``correlation_time_s``, ``bias_per_state_m`` is drawn anew for
    each state of the tow, readings are multiples of ``resolution_m``, and ``stated_std_m`` is
    what the maker states. If that is left out, noise and rounding together are stated.
    """

    unit: ClassVar[str]
    si: ClassVar[float] = 1.0

    correlation_time_s: Seconds = 0.0

    @model_validator(mode='after')
    def _time_for_correlation(self) -> 'Errors':
        if getattr(self, f'correlated_{self.unit}') > 0 and self.correlation_time_s == 0:
            raise ValueError(
                f'correlation_time_s: found 0, expected more, as correlated_{self.unit} is given'
            )
        return self

    def model(self) -> ErrorModel:
        """Give the same errors in SI units."""
        white, correlated, bias, resolution = (
            float(getattr(self, f'{kind}_{self.unit}')) * self.si
            for kind in ('noise', 'correlated', 'bias_per_state', 'resolution')
        )
        stated = getattr(self, f'stated_std_{self.unit}')
        if stated is None:
            # Rounding to multiples of r adds r²/12 of variance.
            stated_std = float(np.hypot(white, resolution / np.sqrt(12)))
        else:
            stated_std = float(stated) * self.si
        return ErrorModel(white, correlated, self.correlation_time_s, bias, resolution, stated_std)


class LengthErrors(Errors):
    """Errors in metres."""

    unit: ClassVar[str] = 'm'

    noise_m: NotNegative = 0.0
    correlated_m: NotNegative = 0.0
    bias_per_state_m: NotNegative = 0.0
    resolution_m: NotNegative = 0.0
    stated_std_m: NotNegative | None = None


class SpeedErrors(Errors):
    """Errors in metres per second."""

    unit: ClassVar[str] = 'm_s'

    noise_m_s: NotNegative = 0.0
    correlated_m_s: NotNegative = 0.0
    bias_per_state_m_s: NotNegative = 0.0
    resolution_m_s: NotNegative = 0.0
    stated_std_m_s: NotNegative | None = None


class ForceErrors(Errors):
    """Errors in kilonewtons."""

    unit: ClassVar[str] = 'kn'
    si: ClassVar[float] = 1e3

    noise_kn: NotNegative = 0.0
    correlated_kn: NotNegative = 0.0
    bias_per_state_kn: NotNegative = 0.0
    resolution_kn: NotNegative = 0.0
    stated_std_kn: NotNegative | None = None


class PressureErrors(Errors):
    """Errors in kilopascals; 10 kPa is about a metre of water."""

    unit: ClassVar[str] = 'kpa'
    si: ClassVar[float] = 1e3

    noise_kpa: NotNegative = 0.0
    correlated_kpa: NotNegative = 0.0
    bias_per_state_kpa: NotNegative = 0.0
    resolution_kpa: NotNegative = 0.0
    stated_std_kpa: NotNegative | None = None


class AngleErrors(Errors):
    """Errors in degrees."""

    unit: ClassVar[str] = 'deg'
    si: ClassVar[float] = np.pi / 180

    noise_deg: NotNegative = 0.0
    correlated_deg: NotNegative = 0.0
    bias_per_state_deg: NotNegative = 0.0
    resolution_deg: NotNegative = 0.0
    stated_std_deg: NotNegative | None = None


class TurnErrors(Errors):
    """Errors in degrees per second."""

    unit: ClassVar[str] = 'deg_s'
    si: ClassVar[float] = np.pi / 180

    noise_deg_s: NotNegative = 0.0
    correlated_deg_s: NotNegative = 0.0
    bias_per_state_deg_s: NotNegative = 0.0
    resolution_deg_s: NotNegative = 0.0
    stated_std_deg_s: NotNegative | None = None


class WinchParameters(Record):
    """Both winches: counter, pay-out speed and load cell; sides err independently."""

    rate_hz: Rate
    length: LengthErrors
    speed: SpeedErrors
    tension: ForceErrors


class PressureParameters(PressureErrors):
    """A pressure sensor."""

    rate_hz: Rate


class AttitudeParameters(AngleErrors):
    """An inclinometer; pitch and roll err alike and independently."""

    rate_hz: Rate


class RangeParameters(LengthErrors):
    """A distance; outside its limits the reading is infinite (REP-117)."""

    rate_hz: Rate
    min_range_m: NotNegative
    max_range_m: Annotated[float, Field(gt=0, le=10_000)]

    @model_validator(mode='after')
    def _limits_in_order(self) -> 'RangeParameters':
        if self.min_range_m >= self.max_range_m:
            raise ValueError(
                f'max_range_m: found {self.max_range_m}, expected more than min_range_m, '
                f'which is {self.min_range_m}'
            )
        return self


class VelocityParameters(Record):
    """A velocity over ground or through the water, with the rate of turn."""

    rate_hz: Rate
    velocity: SpeedErrors
    yaw_rate: TurnErrors


class FixParameters(LengthErrors):
    """A position; east and north err alike and independently."""

    rate_hz: Rate


class HeadingParameters(AngleErrors):
    """A compass."""

    rate_hz: Rate


class DoorParameters(Record):
    """The sensors on the doors, alike on both."""

    pressure: PressureParameters
    attitude: AttitudeParameters
    spread: RangeParameters


class SonarParameters(Record):
    """The trawl sonar on the headrope; its openings come once per sweep."""

    pressure: PressureParameters
    opening_height: RangeParameters
    opening_width: RangeParameters


class VesselParameters(Record):
    """The ship's own sensors, and where on Earth ``map`` has its origin."""

    datum_lat_deg: Annotated[float, Field(ge=-89, le=89)]
    datum_lon_deg: Annotated[float, Field(ge=-180, le=180)]
    velocity_water: VelocityParameters
    velocity_ground: VelocityParameters
    fix: FixParameters
    heading: HeadingParameters


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
        A file that ends in ``.yaml``, or the name of a set that comes with the package.

    Raises
    ------
    InstrumentError
        Naming file, key, what was found and what was expected.
    """
    path = _file_of(path)
    return validated(InstrumentParameters, load_yaml(path, InstrumentError), path, InstrumentError)


def default_instruments_with(
    overrides: dict[str, Any], path: str | Path, error: type[TrawlError], *, prefix: str
) -> InstrumentParameters:
    """Check the default parameters with some of them replaced.

    Parameters
    ----------
    overrides
        Nested as the file is, with those keys only that differ.
    path, prefix
        File and key where the overrides stand, for the error.
    error
        Class of the error to raise.
    """
    defaults = load_yaml(_file_of('default'), InstrumentError)
    return validated(InstrumentParameters, _merged(defaults, overrides), path, error, prefix=prefix)


def _merged(base: dict[str, Any], overrides: dict[str, Any]) -> dict[str, Any]:
    merged = dict(base)
    for key, value in overrides.items():
        both = isinstance(value, dict) and isinstance(base.get(key), dict)
        merged[key] = _merged(base[key], value) if both else value
    return merged


def _file_of(path: str | Path) -> Path:
    if str(path).endswith(('.yaml', '.yml')):
        return Path(path)
    try:
        return share_path('config', 'instruments', f'{path}.yaml')
    except TrawlError as reason:
        raise InstrumentError(str(reason)) from reason
