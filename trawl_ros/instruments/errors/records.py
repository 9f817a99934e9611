# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Records of a channel's errors in a file: one per unit, every key with its unit."""

import math
from collections.abc import Callable
from typing import Annotated, ClassVar, TypeVar

import numpy as np
from pydantic import Field, create_model, model_validator

from trawl_ros.core.schema import Record
from trawl_ros.instruments.errors.channel import ErrorModel
from trawl_ros.instruments.errors.random_processes import BurstModel, NoiseModel

NotNegative = Annotated[float, Field(ge=0)]
Seconds = Annotated[float, Field(ge=0, le=100_000)]
Share = Annotated[float, Field(ge=0, le=1)]
SoundSpeed = Annotated[float, Field(ge=1400, le=1600)]


def both_or_neither(**values: float) -> None:
    """Check that two numbers are both positive or both zero.

    Raises
    ------
    ValueError
        If only one is positive; it names both keys.
    """
    (first, one), (second, other) = values.items()
    if (one > 0) != (other > 0):
        raise ValueError(
            f'{first}: found {one:g} with {second} {other:g}, expected both or neither'
        )


class ChannelErrors(Record):
    """Errors of a channel; keys end in its unit, here m.

    Standard deviations are ``noise_m`` (independent in each sample), ``correlated_m`` (first-order
    process with ``correlation_time_s``), ``bias_per_state_m`` (drawn again for each state of the
    tow) and ``outlier_m`` (for a share ``outlier_share`` of the readings). Noise grows by the part
    ``noise_of_reading`` of the quantity. With ``noise_tail_dof`` it has Student's t distribution
    with these degrees of freedom and the same standard deviation.

    ``scale_error`` is the relative excess of the readings, ``offset_m`` a constant error, and
    ``drift_m_per_hour`` an error that grows from the first reading on. Readings are multiples of
    ``resolution_m``, bounded by ``lowest_m`` and ``highest_m``. The sensor hangs
    ``freezes_per_hour`` times, for ``freeze_s`` on average, and repeats a share ``repeat_share`` of
    its readings. ``stated_std_m`` is the standard deviation that the maker states; by default it is
    that of noise and rounding together.
    """

    unit: ClassVar[str]
    si: ClassVar[float] = 1.0

    correlation_time_s: Seconds = 0.0
    scale_error: Annotated[float, Field(gt=-1, le=10)] = 0.0
    outlier_share: Share = 0.0
    noise_of_reading: Share = 0.0
    noise_tail_dof: Annotated[float, Field(gt=2)] = math.inf
    repeat_share: Share = 0.0
    freezes_per_hour: NotNegative = 0.0
    freeze_s: Seconds = 0.0

    @model_validator(mode='after')
    def _time_for_correlation(self) -> 'ChannelErrors':
        if self._given('correlated') > 0 and self.correlation_time_s == 0:
            raise ValueError(
                f'correlation_time_s: found 0, expected more than 0 with correlated_{self.unit}'
            )
        both_or_neither(freezes_per_hour=self.freezes_per_hour, freeze_s=self.freeze_s)
        size = {f'outlier_{self.unit}': self._given('outlier')}
        both_or_neither(outlier_share=self.outlier_share, **size)
        return self

    def model(self) -> ErrorModel:
        """Return the error model in SI units."""
        white, resolution = self._si('noise'), self._si('resolution')
        stated = getattr(self, f'stated_std_{self.unit}')
        # Rounding to multiples of r adds r²/12 of variance.
        rounded = float(np.hypot(white, resolution / np.sqrt(12)))
        return ErrorModel(
            white=NoiseModel(white, self.noise_of_reading, self.noise_tail_dof),
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
            repeated=self.repeat_share,
            freezes=BurstModel(self.freezes_per_hour, self.freeze_s),
        )

    def _given(self, kind: str) -> float:
        return float(getattr(self, f'{kind}_{self.unit}'))

    def _si(self, kind: str) -> float:
        return self._given(kind) * self.si


ErrorsT = TypeVar('ErrorsT', bound=ChannelErrors)


def in_unit(unit: str, si: float = 1.0) -> Callable[[type[ErrorsT]], type[ErrorsT]]:
    """Add the keys that end in a unit to a record of a channel's errors.

    Parameters
    ----------
    unit
        Ending of the keys.
    si
        Value of the unit in SI.
    """
    keys = {
        f'noise_{unit}': (NotNegative, 0.0),
        f'correlated_{unit}': (NotNegative, 0.0),
        f'bias_per_state_{unit}': (NotNegative, 0.0),
        f'resolution_{unit}': (NotNegative, 0.0),
        f'offset_{unit}': (float, 0.0),
        f'drift_{unit}_per_hour': (float, 0.0),
        f'outlier_{unit}': (NotNegative, 0.0),
        f'lowest_{unit}': (float, -math.inf),
        f'highest_{unit}': (float, math.inf),
        f'stated_std_{unit}': (NotNegative | None, None),
    }

    def with_keys(cls: type[ErrorsT]) -> type[ErrorsT]:
        cls.unit, cls.si = unit, si
        # Pydantic's options are keywords like those of the fields, which mypy cannot tell apart.
        model: type[ErrorsT] = create_model(  # type: ignore[call-overload]  # as said above
            cls.__name__, __base__=cls, __doc__=cls.__doc__, __module__=cls.__module__, **keys
        )
        return model

    return with_keys


@in_unit('m')
class LengthErrors(ChannelErrors):
    """Errors in metres."""


@in_unit('m_s')
class SpeedErrors(ChannelErrors):
    """Errors in metres per second."""


@in_unit('kn', 1e3)
class ForceErrors(ChannelErrors):
    """Errors in kilonewtons."""


@in_unit('kpa', 1e3)
class PressureErrors(ChannelErrors):
    """Errors in kilopascals; 10 kPa is about a metre of water."""


@in_unit('deg', np.pi / 180)
class AngleErrors(ChannelErrors):
    """Errors in degrees."""


@in_unit('deg_s', np.pi / 180)
class TurnErrors(ChannelErrors):
    """Errors in degrees per second."""


@in_unit('db')
class LevelErrors(ChannelErrors):
    """Errors in decibels."""
