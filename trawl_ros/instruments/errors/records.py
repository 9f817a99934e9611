"""Records of a channel's errors in a file: one per unit, every key with its unit."""

import math
from typing import Annotated, ClassVar

import numpy as np
from pydantic import Field, model_validator

from trawl_ros.core.schema import Record
from trawl_ros.instruments.errors.bursts import BurstModel
from trawl_ros.instruments.errors.channel import ErrorModel

NotNegative = Annotated[float, Field(ge=0)]
Seconds = Annotated[float, Field(ge=0, le=100_000)]
Share = Annotated[float, Field(ge=0, le=1)]
SoundSpeed = Annotated[float, Field(ge=1400, le=1600)]


class ChannelErrors(Record):
    """Errors of a channel in a unit of its own.

    Keys end in the unit. Standard deviations are ``noise_m``, drawn per sample, ``correlated_m``
    of a first-order process with ``correlation_time_s``, ``bias_per_state_m``, drawn anew for
    each state of the tow, and ``outlier_m`` of a share ``outlier_share`` of the readings.
    ``scale_error`` is the part by which readings are too large, ``offset_m`` is added to them,
    and ``drift_m_per_hour`` from the first reading on. Readings are multiples of
    ``resolution_m``, none below ``lowest_m`` or above ``highest_m``. The sensor hangs
    ``freezes_per_hour`` times, for ``freeze_s`` in the mean. ``stated_std_m`` is what the maker
    states; if that is left out, noise and rounding together are stated.
    """

    unit: ClassVar[str]
    si: ClassVar[float] = 1.0

    correlation_time_s: Seconds = 0.0
    scale_error: Annotated[float, Field(gt=-1, le=10)] = 0.0
    outlier_share: Share = 0.0
    freezes_per_hour: NotNegative = 0.0
    freeze_s: Seconds = 0.0

    @model_validator(mode='after')
    def _time_for_correlation(self) -> 'ChannelErrors':
        if self._given('correlated') > 0 and self.correlation_time_s == 0:
            raise ValueError(
                f'correlation_time_s: found 0, expected more, as correlated_{self.unit} is given'
            )
        if (self.freezes_per_hour > 0) != (self.freeze_s > 0):
            raise ValueError(
                f'freezes_per_hour: found {self.freezes_per_hour:g} with freeze_s '
                f'{self.freeze_s:g}, expected both or neither'
            )
        if (self.outlier_share > 0) != (self._given('outlier') > 0):
            raise ValueError(
                f'outlier_share: found {self.outlier_share:g} with outlier_{self.unit} '
                f'{self._given("outlier"):g}, expected both or neither'
            )
        return self

    def model(self) -> ErrorModel:
        """Return the error model in SI units."""
        white, resolution = self._si('noise'), self._si('resolution')
        stated = getattr(self, f'stated_std_{self.unit}')
        # Rounding to multiples of r adds r²/12 of variance.
        rounded = float(np.hypot(white, resolution / np.sqrt(12)))
        return ErrorModel(
            white_std=white,
            correlated_std=self._si('correlated'),
            correlation_time=self.correlation_time_s,
            bias_std=self._si('bias_per_state'),
            resolution=resolution,
            stated_std=rounded if stated is None else float(stated) * self.si,
            scale=self.scale_error,
            offset=self._si('offset'),
            drift=float(getattr(self, f'drift_{self.unit}_per_hour')) * self.si,
            outlier_share=self.outlier_share,
            outlier_std=self._si('outlier'),
            lowest=self._si('lowest'),
            highest=self._si('highest'),
            freezes=BurstModel(self.freezes_per_hour, self.freeze_s),
        )

    def _given(self, kind: str) -> float:
        return float(getattr(self, f'{kind}_{self.unit}'))

    def _si(self, kind: str) -> float:
        return self._given(kind) * self.si


class LengthErrors(ChannelErrors):
    """Errors in metres."""

    unit: ClassVar[str] = 'm'

    noise_m: NotNegative = 0.0
    correlated_m: NotNegative = 0.0
    bias_per_state_m: NotNegative = 0.0
    resolution_m: NotNegative = 0.0
    offset_m: float = 0.0
    drift_m_per_hour: float = 0.0
    outlier_m: NotNegative = 0.0
    lowest_m: float = -math.inf
    highest_m: float = math.inf
    stated_std_m: NotNegative | None = None


class SpeedErrors(ChannelErrors):
    """Errors in metres per second."""

    unit: ClassVar[str] = 'm_s'

    noise_m_s: NotNegative = 0.0
    correlated_m_s: NotNegative = 0.0
    bias_per_state_m_s: NotNegative = 0.0
    resolution_m_s: NotNegative = 0.0
    offset_m_s: float = 0.0
    drift_m_s_per_hour: float = 0.0
    outlier_m_s: NotNegative = 0.0
    lowest_m_s: float = -math.inf
    highest_m_s: float = math.inf
    stated_std_m_s: NotNegative | None = None


class ForceErrors(ChannelErrors):
    """Errors in kilonewtons."""

    unit: ClassVar[str] = 'kn'
    si: ClassVar[float] = 1e3

    noise_kn: NotNegative = 0.0
    correlated_kn: NotNegative = 0.0
    bias_per_state_kn: NotNegative = 0.0
    resolution_kn: NotNegative = 0.0
    offset_kn: float = 0.0
    drift_kn_per_hour: float = 0.0
    outlier_kn: NotNegative = 0.0
    lowest_kn: float = -math.inf
    highest_kn: float = math.inf
    stated_std_kn: NotNegative | None = None


class PressureErrors(ChannelErrors):
    """Errors in kilopascals; 10 kPa is about a metre of water."""

    unit: ClassVar[str] = 'kpa'
    si: ClassVar[float] = 1e3

    noise_kpa: NotNegative = 0.0
    correlated_kpa: NotNegative = 0.0
    bias_per_state_kpa: NotNegative = 0.0
    resolution_kpa: NotNegative = 0.0
    offset_kpa: float = 0.0
    drift_kpa_per_hour: float = 0.0
    outlier_kpa: NotNegative = 0.0
    lowest_kpa: float = -math.inf
    highest_kpa: float = math.inf
    stated_std_kpa: NotNegative | None = None


class AngleErrors(ChannelErrors):
    """Errors in degrees."""

    unit: ClassVar[str] = 'deg'
    si: ClassVar[float] = np.pi / 180

    noise_deg: NotNegative = 0.0
    correlated_deg: NotNegative = 0.0
    bias_per_state_deg: NotNegative = 0.0
    resolution_deg: NotNegative = 0.0
    offset_deg: float = 0.0
    drift_deg_per_hour: float = 0.0
    outlier_deg: NotNegative = 0.0
    lowest_deg: float = -math.inf
    highest_deg: float = math.inf
    stated_std_deg: NotNegative | None = None


class TurnErrors(ChannelErrors):
    """Errors in degrees per second."""

    unit: ClassVar[str] = 'deg_s'
    si: ClassVar[float] = np.pi / 180

    noise_deg_s: NotNegative = 0.0
    correlated_deg_s: NotNegative = 0.0
    bias_per_state_deg_s: NotNegative = 0.0
    resolution_deg_s: NotNegative = 0.0
    offset_deg_s: float = 0.0
    drift_deg_s_per_hour: float = 0.0
    outlier_deg_s: NotNegative = 0.0
    lowest_deg_s: float = -math.inf
    highest_deg_s: float = math.inf
    stated_std_deg_s: NotNegative | None = None


class LevelErrors(ChannelErrors):
    """Errors in decibels."""

    unit: ClassVar[str] = 'db'

    noise_db: NotNegative = 0.0
    correlated_db: NotNegative = 0.0
    bias_per_state_db: NotNegative = 0.0
    resolution_db: NotNegative = 0.0
    offset_db: float = 0.0
    drift_db_per_hour: float = 0.0
    outlier_db: NotNegative = 0.0
    lowest_db: float = -math.inf
    highest_db: float = math.inf
    stated_std_db: NotNegative | None = None
