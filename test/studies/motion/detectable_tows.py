"""Four tows of an hour, three states each with hauling between them, on both courses."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from studies.motion.plant import COURSE, towed_samples
from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.bag_motion import STRETCHES
from trawl_ros.estimation.from_gear import finder_for
from trawl_ros.estimation.motion.series import tow_readings
from trawl_ros.estimation.motion.stretches import moving_tow
from trawl_ros.estimation.motion.towing.records import MovingTow
from trawl_ros.estimation.tows import FoundWindows, numbered
from trawl_ros.estimation.windows.records import Rejections, SteadyWindow
from trawl_ros.gear.records import GearRecord
from trawl_ros.lab.trials.linearised_plant import State
from trawl_ros.model.water import build_water
from trawl_ros.records.samples import Sample
from trawl_ros.scenario.records import SteadyStartRecord, StepRecord
from trawl_ros.scenario.scenario import Scenario, load_scenario

STATES: tuple[tuple[State, State, State], ...] = (
    ((550.0, 2.4), (400.0, 2.2), (300.0, 2.0)),
    ((600.0, 2.2), (450.0, 2.4), (320.0, 2.1)),
    ((500.0, 2.3), (380.0, 2.0), (250.0, 1.9)),
    ((420.0, 2.1), (300.0, 2.4), (220.0, 1.9)),
)
"""Warp length (m) and speed (m/s) of the states of each tow."""

STATE_MINUTES = 20.0
"""Of each state, the hauling that leads to it among them."""

HEADINGS = (0.0, np.pi, 0.0, np.pi)
"""ENU yaw (rad) of each tow: both courses of one track."""


@dataclass(frozen=True)
class ReadTows:
    """Tows as they are read: in motion, and their steady windows."""

    moving: tuple[MovingTow, ...]
    windows: tuple[SteadyWindow, ...]


def tow_and_read(gear: GearRecord, coefficients: FloatArray, seeds: Sequence[int]) -> ReadTows:
    """Tow the four with the model as its own plant, and read them by the default instruments.

    Parameters
    ----------
    gear
        Model and plant.
    coefficients
        Of its boards (12,).
    seeds
        Of the instruments in each tow.

    Raises
    ------
    NoSteadyState, StepFailed
        If the gear cannot be towed so.
    """
    moving, found, depth = [], [], build_water(gear).depth
    each = zip(STATES, HEADINGS, seeds, strict=True)
    for number, (states, heading, seed) in enumerate(each, start=1):
        name = f'tow {number}'
        samples = towed_samples(gear, coefficients, 0.0, _course(states), seed, heading)
        moving.append(moving_tow(tow_readings(samples, depth, name), name, STRETCHES))
        windows = _steady_windows(gear, samples)
        found.append(FoundWindows(name, windows, {}, {}, Rejections(), None, ()))
    return ReadTows(tuple(moving), tuple(numbered(found)[0]))


def _course(states: Sequence[State]) -> Scenario:
    """Scenario of a tow; instruments and all else are those of the demo."""
    usual = load_scenario(COURSE)
    (length, speed), *_ = states
    steps = tuple(
        StepRecord(
            name=f'{length:g} m at {speed:g} m/s', minutes=STATE_MINUTES,
            warp_length_m=length, speed_m_s=speed,
        )
        for length, speed in states
    )  # fmt: skip
    start = SteadyStartRecord(warp_length_m=length, speed_m_s=speed)
    record = usual.record.model_copy(update={'start': start, 'steps': steps})
    return replace(usual, record=record)


def _steady_windows(gear: GearRecord, samples: Sequence[Sample]) -> tuple[SteadyWindow, ...]:
    finder = finder_for(gear)
    decided = [item for sample in samples for item in finder.feed(sample)]
    every = (*decided, *finder.finish())
    return tuple(item for item in every if isinstance(item, SteadyWindow))
