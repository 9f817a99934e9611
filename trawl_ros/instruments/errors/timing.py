# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Timing of samples: rate, jitter, latency, dropouts and start-up."""

from dataclasses import dataclass
from typing import Annotated

from pydantic import Field, model_validator

from trawl_ros.core.schema import Record
from trawl_ros.instruments.errors.random_processes import NO_BURSTS, BurstModel
from trawl_ros.instruments.errors.records import NotNegative, Seconds, Share, both_or_neither


@dataclass(frozen=True)
class Timing:
    """Timing of an instrument.

    Attributes
    ----------
    rate
        Samples per second.
    jitter, latency, start_up
        Standard deviation of sampling times, time from sampling to sending, and time without
        samples after switching on, s.
    dropouts, missed
        Bursts in which nothing is sent, and share of single samples that are lost.
    """

    rate: float
    jitter: float = 0.0
    latency: float = 0.0
    start_up: float = 0.0
    dropouts: BurstModel = NO_BURSTS
    missed: float = 0.0


MAX_RATE_HZ = 100.0
"""Greatest number of samples per second."""

Rate = Annotated[float, Field(gt=0, le=MAX_RATE_HZ)]


class Sent(Record):
    """Timing of sending.

    Sending takes ``latency_s``. It fails ``dropouts_per_hour`` times, for ``dropout_s`` on average;
    these lengths are exponentially distributed, or log-normal with ``dropout_log_std``. In
    addition a share ``missed_share`` of single samples is lost.
    """

    latency_s: Seconds = 0.0
    dropouts_per_hour: NotNegative = 0.0
    dropout_s: Seconds = 0.0
    dropout_log_std: Annotated[float, Field(ge=0, le=3)] = 0.0
    missed_share: Share = 0.0

    @model_validator(mode='after')
    def _dropouts_have_a_length(self) -> 'Sent':
        both_or_neither(dropouts_per_hour=self.dropouts_per_hour, dropout_s=self.dropout_s)
        return self

    def timing(self) -> Timing:
        """Return the timing of an instrument that samples at each stamp of the truth."""
        return Timing(
            MAX_RATE_HZ, latency=self.latency_s, dropouts=self._bursts(), missed=self.missed_share
        )

    def _bursts(self) -> BurstModel:
        return BurstModel(self.dropouts_per_hour, self.dropout_s, self.dropout_log_std)


class Timed(Sent):
    """Timing of sampling and sending.

    ``rate_hz`` is the rate of samples, ``jitter_s`` the standard deviation of their times, and
    ``start_up_s`` the time from switching on to the first sample.
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
