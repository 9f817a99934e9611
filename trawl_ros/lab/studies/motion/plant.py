"""Plants of the trials: random boards towed in time, and read by instruments as they come.

The default instruments have no calibration errors, which the fit counts with; so those of each
sensor are drawn for each trial, as the channel table states them.
"""

from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import NoSteadyState, TrawlError
from trawl_ros.estimation.motion.nuisances import ADDED_MASS_STD
from trawl_ros.estimation.motion.towing.towed_gear import TowedGear
from trawl_ros.gear.records import GearRecord
from trawl_ros.instruments.suite import InstrumentSuite
from trawl_ros.lab.studies.identification.plant import Look, State, towed_board
from trawl_ros.lab.studies.identification.readings import AS_STATED, drawn_errors
from trawl_ros.model.gear_model import build_model
from trawl_ros.model.water import build_water
from trawl_ros.records.channels import channel_values, with_channel_values
from trawl_ros.records.samples import PressureSample, Sample
from trawl_ros.scenario.bridge import Bridge
from trawl_ros.scenario.scenario import Scenario
from trawl_ros.scenario.sea import build_sea, build_surroundings
from trawl_ros.simulation.simulation import Simulation
from trawl_ros.solver.stepper import StepFailed

COURSE, AUTOTRAWLED_COURSE = 'demo', 'states_by_autotrawl'
"""Scenarios that are towed: five states in 59 minutes."""

HELD_OUT: tuple[State, ...] = ((380.0, 2.25), (330.0, 2.15), (280.0, 2.0), (225.0, 1.9))
"""Steady states that are predicted and not towed, between those of the course."""

MOST_DRAWS = 20
"""Boards that can be towed at rest, drawn for one trial at most until one can be towed in time."""


STEP_PA = 1000.0
"""Step of pressure by which a metre of water is weighed."""


@dataclass(frozen=True)
class PlantTow:
    """Tow of a drawn board.

    Attributes
    ----------
    gear
        With the drawn coefficients and the fastening points for them.
    added_mass
        As a part of the cylinder of water around a board.
    samples
        Of its instruments, each calibrated as wrongly as the channel table states.
    held_out
        Observables of the plant in `HELD_OUT`.
    rejected
        Boards drawn before that cannot be towed, by reason.
    """

    gear: GearRecord
    added_mass: float
    samples: tuple[Sample, ...]
    held_out: tuple[Look, ...]
    rejected: Counter[str]

    @property
    def coefficients(self) -> FloatArray:
        """Coefficients (12,) of its boards."""
        return self.gear.board.coefficients.array()


def draw_tow(record: GearRecord, course: Scenario, chance: np.random.Generator) -> PlantTow:
    """Draw boards and their added mass until they can be towed, at rest and in time, and the
    calibration of the sensors that read them.

    Parameters
    ----------
    record
        The plant.
    course
        Scenario whose commands are towed.
    chance
        Generator of random numbers.

    Raises
    ------
    TrawlError
        If none of `MOST_DRAWS` boards that have their steady states tows the course.
    """
    states = tuple((command.port_length, command.speed) for _, command in course.commands)
    rejected: Counter[str] = Counter()
    for _ in range(MOST_DRAWS):
        board = towed_board(record, (states, HELD_OUT), chance)
        gear = board.drawn.gear
        rejected += board.drawn.rejected
        added_mass = ADDED_MASS_STD * abs(chance.standard_normal())
        seed = int(chance.integers(2**31))
        try:
            samples = towed_samples(gear, board.drawn.coefficients, added_mass, course, seed)
        except (NoSteadyState, StepFailed):
            rejected['in time'] += 1
            continue
        depth, errors = build_water(record).depth, drawn_errors(AS_STATED, chance)
        read = tuple(miscalibrated(sample, depth, *errors) for sample in samples)
        return PlantTow(gear, added_mass, read, board.tows[1], rejected)
    raise TrawlError(f'none of {MOST_DRAWS} boards that can be towed at rest tows the course')


def miscalibrated(
    sample: Sample,
    depth: Callable[[float], float],
    offsets: Mapping[str, float],
    scales: Mapping[str, float],
) -> Sample:
    """Sample as sensors show it whose calibration is wrong.

    Parameters
    ----------
    sample
        Of any instrument.
    depth
        Depth (m) under the surface for an absolute pressure (Pa).
    offsets, scales
        Offset (SI) and error of scale of each channel.
    """
    shown = {
        name: value * (1.0 + scales[name]) + offsets[name]
        for name, value in channel_values(sample, depth).items()
        if name in offsets
    }

    def pressure(shown_depth: float) -> float:
        assert isinstance(sample, PressureSample)
        # Water's weight changes little within what a sensor is wrong by.
        true = sample.pressure
        metre = STEP_PA / (depth(true + STEP_PA) - depth(true))
        return true + metre * (shown_depth - depth(true))

    return with_channel_values(sample, shown, pressure)


def towed_samples(
    record: GearRecord,
    coefficients: FloatArray,
    added_mass: float,
    course: Scenario,
    seed: int,
    heading: float = 0.0,
) -> tuple[Sample, ...]:
    """Samples of a tow; the autotrawl, if there is one, goes by readings as the suite has them.

    Parameters
    ----------
    record
        The plant.
    coefficients, added_mass
        Of its boards: coefficients (12,), and a part of the cylinder of water around a board.
    course
        Scenario whose commands are towed, by its instruments.
    seed
        Of instruments and sea.
    heading
        ENU yaw, rad.

    Raises
    ------
    NoSteadyState, StepFailed
        If it cannot be towed.
    """
    course = replace(course, record=course.record.model_copy(update={'seed': seed}))
    gear = TowedGear(build_model(record).with_coefficients(coefficients))
    sea = build_sea(course.record.sea, gear.model.water, seed)
    # As often as any instrument looks; the solver steps twice as far.
    period = 1.0 / course.record.truth_rate_hz
    simulation = Simulation(
        gear.model, course.start, heading=heading, period=period, sea=sea,
        effect_set=gear.with_added_mass(added_mass),
    )  # fmt: skip
    suite = InstrumentSuite(
        course.instruments, surroundings=build_surroundings(record), draws=course.draws
    )
    bridge = Bridge(course)
    samples: list[Sample] = []
    for number in range(1 + round(course.duration_s / period)):
        if number:
            simulation.command = bridge.command(period * (number - 1))
            simulation.advance()
        truth = simulation.truth()
        bridge.observe(truth)
        samples += suite.observe(truth)
    return tuple(samples)
