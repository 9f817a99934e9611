"""Records of an instrument's timing in a file."""

from typing import Annotated

from pydantic import Field, model_validator

from trawl_ros.instruments.bursts import BurstModel
from trawl_ros.instruments.error_records import NotNegative, Seconds
from trawl_ros.instruments.timing import Timing
from trawl_ros.schema import Record

MOST_OFTEN = 100.0
"""Samples per second, at most."""

Rate = Annotated[float, Field(gt=0, le=MOST_OFTEN)]


class Sent(Record):
    """Timing of sending.

    It takes ``latency_s``, and fails ``dropouts_per_hour`` times, for ``dropout_s`` in the mean.
    """

    latency_s: Seconds = 0.0
    dropouts_per_hour: NotNegative = 0.0
    dropout_s: Seconds = 0.0

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
        return Timing(MOST_OFTEN, latency=self.latency_s, dropouts=self._bursts())

    def _bursts(self) -> BurstModel:
        return BurstModel(self.dropouts_per_hour, self.dropout_s)


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
        return Timing(self.rate_hz, self.jitter_s, self.latency_s, self.start_up_s, self._bursts())
