# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Scenario: gear, commands of ship and winches, instruments and recording of a trial."""

import math
from bisect import bisect_right
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from pathlib import Path

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import InstrumentError, ScenarioError, TrawlError
from trawl_ros.core.resources import packaged
from trawl_ros.core.schema import load_yaml, validated
from trawl_ros.effects.effect_set import EffectSet, effects_of
from trawl_ros.effects.sensor_effects import SensorEffects
from trawl_ros.gear.load import load_gear
from trawl_ros.gear.records import GearRecord
from trawl_ros.instruments.errors.fault_plan import PlannedFault
from trawl_ros.instruments.errors.instrument import SeedPlan
from trawl_ros.instruments.parameters import (
    InstrumentParameters,
    default_instruments_with,
    load_instruments,
)
from trawl_ros.model.water import build_water
from trawl_ros.records.surroundings import Surroundings
from trawl_ros.scenario.driving import NOBODY, AutotrawlRecord, SteerRecord
from trawl_ros.scenario.records import ScenarioRecord, SteadyStartRecord, StepRecord
from trawl_ros.scenario.sea import build_surroundings
from trawl_ros.simulation.command import Command


@dataclass(frozen=True)
class Driving:
    """Controllers in a step: target of the autopilot, and autotrawl."""

    steer: SteerRecord | None = None
    autotrawl: AutotrawlRecord = NOBODY


@dataclass(frozen=True)
class Scenario:
    """Scenario with its gear and instruments.

    ``path`` is the file and ``gear`` the content of the gear file. ``plant`` is the true gear, with
    the refinement, coefficients and water of the scenario.

    Examples
    --------
    >>> import trawl_ros
    >>> scenario = trawl_ros.load_scenario('config/scenarios/demo.yaml')
    >>> begin, command = scenario.commands[1]
    >>> begin, command.port_length, command.speed
    (552.0, 350.0, 2.2)
    """

    path: Path
    record: ScenarioRecord
    gear: GearRecord
    plant: GearRecord
    instruments: InstrumentParameters

    @property
    def gear_file(self) -> str | Path:
        """Gear file, or name of a gear of the package."""
        return _beside(self.path, self.record.gear)

    @property
    def heading(self) -> float:
        """Heading at the start, ENU yaw, rad."""
        return math.radians(self.record.heading_deg)

    @cached_property
    def commands(self) -> tuple[tuple[float, Command], ...]:
        """Command of each step with its beginning (s since the start)."""
        command = self.start
        begin = 0.0
        listed = []
        for step in self.record.steps:
            command = _after(command, step)
            listed.append((begin, command))
            begin += 60 * step.minutes
        return tuple(listed)

    @cached_property
    def drivings(self) -> tuple[Driving, ...]:
        """Controllers of each step."""
        driving = Driving()
        listed = []
        for step in self.record.steps:
            steer = None if step.turn_deg_s is not None else step.steer or driving.steer
            driving = Driving(steer, step.autotrawl or driving.autotrawl)
            listed.append(driving)
        return tuple(listed)

    @property
    def steered(self) -> bool:
        """True if an autopilot steers in any step."""
        return any(driving.steer is not None for driving in self.drivings)

    @property
    def autotrawled(self) -> bool:
        """True if an autotrawl controls the winches in any step."""
        return any(driving.autotrawl.mode != 'off' for driving in self.drivings)

    @property
    def start(self) -> Command:
        """Command of the steady tow before the first step."""
        first = self.record.start
        port, starboard = _lengths(first)
        if port is None or starboard is None:
            raise ScenarioError(f'{self.path}: start.warp_length_m: missing, expected a length')
        return Command(port, starboard, first.speed_m_s)

    @property
    def duration_s(self) -> float:
        """Duration of the trial, s."""
        return sum(60 * step.minutes for step in self.record.steps)

    @property
    def state_changes_s(self) -> tuple[float, ...]:
        """Times (s) of changes of commands or controllers, after the start itself."""
        steps = [(*step, who) for step, who in zip(self.commands, self.drivings, strict=True)]
        return tuple(after[0] for before, after in pairwise(steps) if after[1:] != before[1:])

    @property
    def draws(self) -> SeedPlan:
        """Seed plan of the instruments: seed and times of changes."""
        return SeedPlan(self.record.seed, self.state_changes_s)

    @cached_property
    def surroundings(self) -> Surroundings:
        """Water around the instruments."""
        return build_surroundings(self.plant)

    @cached_property
    def effect_set(self) -> EffectSet:
        """Effect set of the plant beyond the model."""
        return effects_of(self.plant)

    def sensor_effects(self) -> SensorEffects:
        """Return the converter of samples for a plant with these effects."""
        return SensorEffects(self.effect_set, build_water(self.plant))

    @property
    def faults(self) -> tuple[PlannedFault, ...]:
        """Planned faults of instruments."""
        return tuple(record.planned() for record in self.record.faults)

    def step_at(self, time: float) -> StepRecord:
        """Return the step at a time (s since the start)."""
        return self.record.steps[self._number(time)]

    def commands_at(self, time: float) -> Command:
        """Return the command at a time (s since the start); after the end, the last."""
        return self.commands[self._number(time)][1]

    def driving_at(self, time: float) -> Driving:
        """Return the controllers at a time (s since the start); after the end, the last."""
        return self.drivings[self._number(time)]

    def _number(self, time: float) -> int:
        begins = [begin for begin, _ in self.commands]
        # Rounding may put the first instant of a step just before it.
        return max(0, bisect_right(begins, time + 1e-6) - 1)


def load_scenario(path: str | Path) -> Scenario:
    """Read and check a scenario file, with its gear and instruments.

    Parameters
    ----------
    path
        File, or name of a scenario of the package, such as ``'demo'``. Gear and instrument files
        with names in ``.yaml`` are sought in the same folder, others in the package.

    Returns
    -------
    Scenario
        Checked, with gear and instruments loaded.

    Raises
    ------
    ScenarioError
        With file, key, what was found and what was expected.

    Examples
    --------
    >>> import trawl_ros
    >>> scenario = trawl_ros.load_scenario('config/scenarios/demo.yaml')
    >>> scenario.duration_s, len(scenario.commands)
    (3564.0, 5)
    """
    path = packaged(path, 'scenarios', ScenarioError)
    record = validated(ScenarioRecord, load_yaml(path, ScenarioError), path, ScenarioError)
    try:
        gear = load_gear(_beside(path, record.gear))
    except TrawlError as reason:
        raise ScenarioError(f"{path}: gear: '{record.gear}' cannot be used: {reason}") from reason
    plant, instruments = _plant(gear, record, path), _instruments(record, path)
    scenario = Scenario(path, record, gear, plant, instruments)
    _check_faults(scenario)
    return scenario


def _check_faults(scenario: Scenario) -> None:
    """Check that the instruments can have the planned faults."""
    if not scenario.faults:
        return
    # Imported here, because a node needs only one group of instruments.
    from trawl_ros.instruments.suite import InstrumentSuite

    panel = InstrumentSuite(
        scenario.instruments, surroundings=scenario.surroundings, draws=scenario.draws
    ).panel
    for number, fault in enumerate(scenario.faults):
        try:
            panel.check(fault.where, fault.what)
        except InstrumentError as reason:
            raise ScenarioError(f'{scenario.path}: faults[{number}]: {reason}') from reason


def _beside(path: Path, name: str) -> str | Path:
    return path.parent / name if name.endswith(('.yaml', '.yml')) else name


def _instruments(record: ScenarioRecord, path: Path) -> InstrumentParameters:
    wanted = record.instruments
    if isinstance(wanted, dict):
        return default_instruments_with(wanted, path, ScenarioError, prefix='instruments')
    try:
        return load_instruments(_beside(path, wanted))
    except InstrumentError as reason:
        raise ScenarioError(f"{path}: instruments: '{wanted}' cannot be used: {reason}") from reason


def _plant(gear: GearRecord, record: ScenarioRecord, path: Path) -> GearRecord:
    factors = record.refine
    finer = gear.refined(**factors.model_dump())
    data = finer.model_dump()
    data['board']['coefficients'] |= record.coefficients.model_dump(exclude_none=True)
    data['water'] |= record.water.model_dump(exclude_none=True)
    data['effects'] = (*data['effects'], *(effect.model_dump() for effect in record.effects))
    # Validate again, because changed values must fit the others.
    return validated(GearRecord, data, path, ScenarioError, prefix='plant')


def _after(command: Command, step: StepRecord) -> Command:
    port, starboard = _lengths(step)
    return Command(
        command.port_length if port is None else port,
        command.starboard_length if starboard is None else starboard,
        command.speed if step.speed_m_s is None else step.speed_m_s,
        _turn_rate(command, step),
    )


def _turn_rate(command: Command, step: StepRecord) -> float:
    if step.steer is not None:
        return 0.0
    return command.turn_rate if step.turn_deg_s is None else math.radians(step.turn_deg_s)


def _lengths(record: SteadyStartRecord | StepRecord) -> tuple[float | None, float | None]:
    if record.warp_length_m is not None:
        return record.warp_length_m, record.warp_length_m
    return record.port_warp_length_m, record.starboard_warp_length_m


def true_coefficients(path: str | Path) -> FloatArray:
    """Read the coefficients (12,) of a scenario's plant, in the order of eq. 36."""
    return load_scenario(path).plant.board.coefficients.array()
