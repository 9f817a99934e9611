"""Record of an instrument's fault in a scenario file."""

from typing import Annotated

from pydantic import Field, field_validator

from trawl_ros.core.errors import InstrumentError
from trawl_ros.core.schema import Record
from trawl_ros.instruments.errors.fault_plan import PlannedFault
from trawl_ros.instruments.errors.faults import parse_fault

MINUTE = 60.0


class FaultRecord(Record):
    """A fault that begins ``at_min`` after the start, for so long or to the end.

    ``where`` is an instrument's topic, or topic/quantity; ``what`` a kind of fault and its size in
    SI units, such as 'frozen' or 'offset -3.5'.
    """

    at_min: Annotated[float, Field(ge=0, le=100_000)]
    for_min: Annotated[float, Field(gt=0, le=100_000)] | None = None
    where: Annotated[str, Field(min_length=1, max_length=100)]
    what: Annotated[str, Field(min_length=1, max_length=100)]

    @field_validator('what')
    @classmethod
    def _is_a_fault(cls, what: str) -> str:
        try:
            fault = parse_fault(what)
        except InstrumentError as reason:
            raise ValueError(str(reason)) from reason
        if fault is None:
            raise ValueError("found 'none', expected a fault; its end is said by for_min")
        return what

    def planned(self) -> PlannedFault:
        """Return the planned fault for the instruments."""
        begin = MINUTE * self.at_min
        end = None if self.for_min is None else begin + MINUTE * self.for_min
        return PlannedFault(begin, end, self.where, self.what)
