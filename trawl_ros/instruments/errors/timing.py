"""Timing of samples: rate, jitter, latency, dropouts and start-up."""

from dataclasses import dataclass
from typing import Annotated

from pydantic import Field, model_validator

from trawl_ros.core.schema import Record
from trawl_ros.instruments.errors.bursts import NO_BURSTS, BurstModel
from trawl_ros.instruments.errors.records import NotNegative, Seconds, Share


@dataclass(frozen=True)
class Timing:
    """Timing of an instrument; times in s.

    ``rate`` in samples per second; ``jitter`` is the standard deviation with which samples are
    off the beat, ``latency`` the time from sampling to sending, ``start_up`` the time after
    switching on in which nothing is sampled; ``dropouts`` are spells in which nothing is sent,
    and of the other samples the share ``missed`` is lost one by one.
    """

    rate: float
    jitter: float = 0.0
    latency: float = 0.0
    start_up: float = 0.0
    dropouts: BurstModel = NO_BURSTS
    missed: float = 0.0


MOST_OFTEN = 100.0
"""Samples per second, at most."""

Rate = Annotated[float, Field(gt=0, le=MOST_OFTEN)]


class Sent(Record):
    """Timing of sending.

    It takes ``latency_s``, and fails ``dropouts_per_hour`` times, for ``dropout_s`` in the mean;
    these lengths are exponentially distributed, or log-normal with ``dropout_log_std``. A share
    ``missed_share`` of the samples is lost besides, one by one.
    """

    latency_s: Seconds = 0.0
    dropouts_per_hour: NotNegative = 0.0
    dropout_s: Seconds = 0.0
    dropout_log_std: Annotated[float, Field(ge=0, le=3)] = 0.0
    missed_share: Share = 0.0

    @model_validator(mode='after')
    def _dropouts_have_a_length(self) -> 'Sent':
        if (self.dropouts_per_hour > 0) != (self.dropout_s > 0):
            raise ValueError(
                f'dropouts_per_hour: found {self.dropouts_per_hour:g} with dropout_s '
                f'{self.dropout_s:g}, expected both or neither'
            )
        return self

    def timing(self) -> Timing:
        """Return the timing of an instrument that samples whenever truth comes."""
        return Timing(
            MOST_OFTEN, latency=self.latency_s, dropouts=self._bursts(), missed=self.missed_share
        )

    def _bursts(self) -> BurstModel:
        return BurstModel(self.dropouts_per_hour, self.dropout_s, self.dropout_log_std)


class Timed(Sent):
    """Timing of sampling and sending.

    ``rate_hz`` is that of its samples; ``jitter_s`` the standard deviation with which they are
    off the beat, ``start_up_s`` the time after switching on before the first.
    """

    rate_hz: Rate
    jitter_s: Seconds = 0.0
    start_up_s: Seconds = 0.0

    def timing(self) -> Timing:
        """Return the timing of the instrument."""
        return Timing(
            self.rate_hz,
            self.jitter_s,
            self.latency_s,
            self.start_up_s,
            self._bursts(),
            self.missed_share,
        )
