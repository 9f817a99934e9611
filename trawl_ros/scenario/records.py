# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Records of the scenario file: every key names its unit, and every value is checked on load."""

from typing import Annotated, Any, Literal

from pydantic import Field, field_validator, model_validator

from trawl_ros.core.errors import InstrumentError
from trawl_ros.core.schema import Record
from trawl_ros.gear.records import EffectRecord
from trawl_ros.gear.sea_water import CurrentAt, TemperatureAt
from trawl_ros.instruments.errors.fault_plan import PlannedFault
from trawl_ros.instruments.errors.faults import parse_fault
from trawl_ros.records.towing_limits import LIMITS
from trawl_ros.scenario.driving import AutotrawlRecord, SteerRecord
from trawl_ros.scenario.sea import SeaRecord

Length = Annotated[float, Field(ge=LIMITS.warp_m[0], le=LIMITS.warp_m[1])]
Speed = Annotated[float, Field(ge=LIMITS.speed_m_s[0], le=LIMITS.speed_m_s[1])]
Factor = Annotated[int, Field(ge=1, le=8)]
NetFactor = Annotated[float, Field(ge=1, le=8)]
Name = Annotated[str, Field(min_length=1, max_length=100)]

MAX_HOURS = 48
MAX_TRUTH_HZ = 10.0
"""Highest rate of the truth."""


def _check_lengths(record: 'SteadyStartRecord | StepRecord', *, needed: bool) -> None:
    both = record.warp_length_m is not None
    sides = [record.port_warp_length_m, record.starboard_warp_length_m]
    given = sum(side is not None for side in sides)
    if both and given:
        raise ValueError(
            'warp_length_m: found together with port_warp_length_m or starboard_warp_length_m, '
            'expected either one length or one per side'
        )
    if needed and not both and given < 2:
        raise ValueError(
            'warp_length_m: missing, expected a length (metres), or port_warp_length_m and '
            'starboard_warp_length_m'
        )


class SteadyStartRecord(Record):
    """Steady tow at the start of a trial."""

    warp_length_m: Length | None = None
    port_warp_length_m: Length | None = None
    starboard_warp_length_m: Length | None = None
    speed_m_s: Speed

    @model_validator(mode='after')
    def _lengths(self) -> 'SteadyStartRecord':
        _check_lengths(self, needed=True)
        return self


class StepRecord(Record):
    """Step of a trial: its minutes, and new targets for the named quantities.

    Quantities without a new target keep their values, including the rate of turn. A rate of turn
    ends the steering of an earlier step.
    """

    name: Name
    minutes: Annotated[float, Field(gt=0, le=60 * MAX_HOURS)]
    warp_length_m: Length | None = None
    port_warp_length_m: Length | None = None
    starboard_warp_length_m: Length | None = None
    speed_m_s: Speed | None = None
    turn_deg_s: Annotated[float, Field(ge=-LIMITS.turn_deg_s, le=LIMITS.turn_deg_s)] | None = None
    steer: SteerRecord | None = None
    autotrawl: AutotrawlRecord | None = None

    @model_validator(mode='after')
    def _lengths(self) -> 'StepRecord':
        _check_lengths(self, needed=False)
        return self

    @model_validator(mode='after')
    def _one_helm(self) -> 'StepRecord':
        if self.steer is not None and self.turn_deg_s is not None:
            raise ValueError('turn_deg_s: found together with steer, expected one of them')
        return self


class RefineRecord(Record):
    """Refinement of the plant's mesh compared with the gear file.

    The net is refined to the nearest multiple of 12 meshes around its mouth. ``unjoined`` keeps all
    of them to its end.
    """

    warp: Factor = 1
    bridle: Factor = 1
    net: NetFactor = 1.0
    unjoined: bool = False


class WaterOverrides(Record):
    """Overrides of the gear file's water."""

    density_kg_m3: Annotated[float, Field(ge=990, le=1060)] | None = None
    density_gradient_kg_m4: Annotated[float, Field(ge=0, le=0.1)] | None = None
    current: Annotated[tuple[CurrentAt, ...], Field(max_length=200)] | None = None
    temperature: (
        Annotated[tuple[TemperatureAt, ...], Field(min_length=1, max_length=200)] | None
    ) = None
    salinity_g_kg: Annotated[float, Field(ge=0, le=42)] | None = None


class CoefficientOverrides(Record):
    """Overrides of the gear file's board coefficients (eq. 14)."""

    a1: float | None = None
    c1: float | None = None
    a2: float | None = None
    c2: float | None = None
    b3: float | None = None
    c3: float | None = None
    a4: float | None = None
    c4: float | None = None
    b5: float | None = None
    c5: float | None = None
    a6: float | None = None
    c6: float | None = None


class FaultRecord(Record):
    """Fault of an instrument from ``at_min`` after the start, for ``for_min`` or to the end.

    ``where`` is the instrument's topic, or topic/quantity. ``what`` is a kind of fault and its size
    in SI units, such as 'frozen' or 'offset -3.5'.
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
            raise ValueError("found 'none', expected a fault; for_min gives its end")
        return what

    def planned(self) -> PlannedFault:
        """Return the planned fault for the instruments."""
        begin = 60.0 * self.at_min
        end = None if self.for_min is None else begin + 60.0 * self.for_min
        return PlannedFault(begin, end, self.where, self.what)


class ScenarioRecord(Record):
    """Scenario: the records of a trial's YAML file.

    ``effects`` are added to those of the gear file. ``record`` selects the topics of the bag:
    ``pictures`` are the sonar's image, scan and points, ``instruments`` all other measurements.
    ``truth_rate_hz`` is the rate of the truth, which the instruments observe.
    """

    description: Annotated[str, Field(min_length=1, max_length=300)]
    gear: Name
    refine: RefineRecord = RefineRecord()
    coefficients: CoefficientOverrides = CoefficientOverrides()
    water: WaterOverrides = WaterOverrides()
    effects: Annotated[tuple[EffectRecord, ...], Field(max_length=20)] = ()
    sea: SeaRecord = SeaRecord()
    instruments: str | dict[str, Any] = 'default'
    faults: Annotated[tuple[FaultRecord, ...], Field(max_length=1000)] = ()
    seed: Annotated[int, Field(ge=0, lt=2**32)] = 0
    heading_deg: Annotated[float, Field(ge=-360, le=360)] = 0.0
    start: SteadyStartRecord
    steps: Annotated[tuple[StepRecord, ...], Field(min_length=1, max_length=1000)]
    truth_rate_hz: Annotated[float, Field(ge=0.1, le=MAX_TRUTH_HZ)] = MAX_TRUTH_HZ
    record: Annotated[
        tuple[Literal['instruments', 'pictures', 'truth', 'transforms'], ...],
        Field(min_length=1, max_length=4),
    ] = ('instruments', 'pictures', 'truth')

    @model_validator(mode='after')
    def _whole_decimation(self) -> 'ScenarioRecord':
        every = MAX_TRUTH_HZ / self.truth_rate_hz
        if abs(every - round(every)) > 1e-9 * every:
            raise ValueError(
                f'truth_rate_hz: found {self.truth_rate_hz:g}, expected {MAX_TRUTH_HZ:g} '
                'divided by a whole number (hertz)'
            )
        return self

    @model_validator(mode='after')
    def _not_endless(self) -> 'ScenarioRecord':
        minutes = sum(step.minutes for step in self.steps)
        if minutes > 60 * MAX_HOURS:
            raise ValueError(
                f'steps: found {minutes:g} minutes in total, expected at most {60 * MAX_HOURS}'
            )
        for number, fault in enumerate(self.faults):
            if fault.at_min >= minutes:
                raise ValueError(
                    f'faults[{number}].at_min: found {fault.at_min:g}, expected less than the '
                    f'{minutes:g} minutes of all steps'
                )
        return self
