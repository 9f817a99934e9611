"""The suite and its groups give the same data, whatever else is on board."""

import math
from collections import Counter
from dataclasses import replace
from typing import Protocol

import numpy as np
import pytest

from trawl_ros.core.time import SECOND
from trawl_ros.instruments.doors import DoorInstruments
from trawl_ros.instruments.errors.instrument import SeedPlan
from trawl_ros.instruments.parameters import InstrumentParameters, load_instruments
from trawl_ros.instruments.suite import InstrumentSuite
from trawl_ros.instruments.trawl_sonar import SonarInstruments
from trawl_ros.instruments.vessel import VesselInstruments
from trawl_ros.instruments.winch import WinchInstruments
from trawl_ros.model.water import Water
from trawl_ros.records.samples import (
    AttitudeSample,
    PressureSample,
    RangeSample,
    Sample,
    VelocitySample,
    WinchSample,
)
from trawl_ros.records.surroundings import Surroundings
from trawl_ros.records.truth import DoorTruth, NetTruth, Truth, VesselTruth, WinchTruth

PRESSURE = Water().pressure
SEA = Surroundings(PRESSURE)
DRAWS = SeedPlan(seed=3)
LEVEL = np.array([0.0, 0.0, 0.0, 1.0])


def door(y: float) -> DoorTruth:
    nothing = np.zeros(3)
    return DoorTruth(
        np.array([-400.0, y, -110.0]), LEVEL, nothing, nothing, 0.3, 0.0, 0.2, nothing, nothing
    )


TRUTH = Truth(
    stamp=0,
    doors=(door(60.0), door(-60.0)),
    winches=(WinchTruth(500.0, 0.0, 160e3), WinchTruth(500.0, 0.0, 160e3)),
    net=NetTruth(np.zeros((2, 3)), 30.0, 20.0, 130.0, np.array([-600.0, 0.0, -130.0]), LEVEL),
    vessel=VesselTruth(np.zeros(3), 0.0, 0.0, np.array([2.1, 0.0, 0.0]), np.array([2.1, 0.0, 0.0])),
)


def tow(seconds: int, start: int = 0) -> list[Truth]:
    return [replace(TRUTH, stamp=start + k * SECOND // 10) for k in range(10 * seconds + 1)]


class Observer(Protocol):
    """A suite, or a group of instruments on its own."""

    def observe(self, truth: Truth) -> list[Sample]: ...


def observed(instruments: Observer, truths: list[Truth]) -> list[Sample]:
    return [sample for truth in truths for sample in instruments.observe(truth)]


def suite(
    draws: SeedPlan = DRAWS, parameters: InstrumentParameters | None = None
) -> InstrumentSuite:
    return InstrumentSuite(parameters or load_instruments(), surroundings=SEA, draws=draws)


def kind(sample: Sample) -> str:
    match sample:
        case PressureSample():
            return f'pressure {sample.place}'
        case AttitudeSample():
            return f'attitude {sample.side}'
        case RangeSample():
            return sample.what
        case VelocitySample():
            return f'velocity {sample.over}'
        case _:
            return type(sample).__name__


def heard_always() -> InstrumentParameters:
    """The default instruments with range sensors that keep their beat and lose no reading."""
    default = load_instruments()
    kept = {'jitter_s': 0.0, 'missed_share': 0.0, 'dropouts_per_hour': 0.0, 'dropout_s': 0.0}
    spread, bottom = (
        sensor.model_copy(update=kept) for sensor in (default.door.spread, default.sonar.bottom)
    )
    return default.model_copy(
        update={
            'door': default.door.model_copy(update={'spread': spread}),
            'sonar': default.sonar.model_copy(update={'bottom': bottom}),
        }
    )


def test_range_sensors_lose_as_many_readings_as_those_of_a_survey() -> None:
    counts = Counter(kind(sample) for sample in observed(suite(), tow(3600)))
    # The middle 90 % of its hauls: docs/studies/instruments.md.
    assert 60 * 10.48 <= counts['spread'] <= 60 * 18.04
    assert 60 * 10.77 <= counts['bottom'] <= 60 * 41.42


def test_a_minute_at_sea_has_as_many_samples_as_the_rates_say() -> None:
    counts = Counter(kind(sample) for sample in observed(suite(parameters=heard_always()), tow(60)))
    assert counts == {
        'WinchSample': 121,
        'pressure port': 61,
        'pressure starboard': 61,
        'attitude port': 31,
        'attitude starboard': 31,
        'spread': 20,
        'pressure sonar': 61,
        'bottom': 61,
        'SonarImageSample': 3,
        'SonarScanSample': 3,
        'SonarPointsSample': 3,
        'opening_height': 3,
        'opening_width': 3,
        'velocity water': 61,
        'velocity ground': 61,
        'FixSample': 61,
        'HeadingSample': 61,
        'depth': 61,
        'school': 61,
        'SchoolsSample': 7,
    }


def test_all_samples_carry_the_stamp_of_their_truth_and_a_sweep_that_of_its_first_ping() -> None:
    boat = suite()
    for truth in tow(35, start=17):
        for sample in boat.observe(truth):
            swept = kind(sample).startswith(('Sonar', 'opening'))
            assert sample.stamp == truth.stamp - (16 * SECOND if swept else 0)


def test_a_group_alone_gives_what_the_whole_suite_gives() -> None:
    parameters, draws = load_instruments(), SeedPlan(seed=3, state_changes=(10.0,))
    groups = (
        WinchInstruments(parameters.winch, draws),
        DoorInstruments(parameters.door, draws, surroundings=SEA),
        SonarInstruments(parameters.sonar, draws, surroundings=SEA),
        VesselInstruments(parameters.vessel, draws, surroundings=SEA),
    )
    alone = [repr(s) for group in groups for s in observed(group, tow(30))]
    whole = [repr(s) for s in observed(suite(draws), tow(30))]
    assert sorted(alone) == sorted(whole)


def test_a_change_to_one_sensor_changes_no_other() -> None:
    parameters = load_instruments()
    spread = parameters.door.spread.model_copy(update={'noise_m': 9.0, 'rate_hz': 5.0})
    changed = parameters.model_copy(
        update={'door': parameters.door.model_copy(update={'spread': spread})}
    )
    before = [s for s in observed(suite(), tow(30)) if kind(s) != 'spread']
    after = [s for s in observed(suite(parameters=changed), tow(30)) if kind(s) != 'spread']
    assert list(map(repr, before)) == list(map(repr, after))


def test_the_seed_decides_on_all_data() -> None:
    one, again = (list(map(repr, observed(suite(), tow(10)))) for _ in range(2))
    other = list(map(repr, observed(suite(SeedPlan(seed=4)), tow(10))))
    assert one == again
    assert one != other


def test_a_backward_jump_gives_the_data_of_a_new_ship() -> None:
    boat = suite(SeedPlan(seed=3, state_changes=(5.0,)))
    first = list(map(repr, observed(boat, tow(10))))
    second = list(map(repr, observed(boat, tow(10))))
    assert first == second


def test_biases_change_with_the_states_of_the_tow_and_only_then() -> None:
    parameters = load_instruments()
    pressure = parameters.door.pressure.model_copy(
        update={'noise_kpa': 0.0, 'resolution_kpa': 0.0, 'bias_per_state_kpa': 5.0}
    )
    biased = parameters.model_copy(
        update={'door': parameters.door.model_copy(update={'pressure': pressure})}
    )
    start = 1_000 * SECOND
    samples = observed(suite(SeedPlan(3, (20.0, 40.0)), biased), tow(60, start))
    port = [s for s in samples if isinstance(s, PressureSample) and s.place == 'port']
    by_state = [
        {s.pressure for s in port if low <= (s.stamp - start) / SECOND < high}
        for low, high in ((0, 20), (20, 40), (40, 61))
    ]
    assert [len(values) for values in by_state] == [1, 1, 1]
    assert len(set.union(*by_state)) == 3
    assert all(abs(v - PRESSURE(110.0)) < 25e3 for v in set.union(*by_state))


def test_the_default_errors_are_those_of_real_sensors() -> None:
    samples = observed(suite(), tow(600))
    port = np.array(
        [s.pressure for s in samples if isinstance(s, PressureSample) and s.place == 'port']
    )
    tension = np.array([s.tensions[0] for s in samples if isinstance(s, WinchSample)])
    spread = np.array(
        [s.distance for s in samples if isinstance(s, RangeSample) and s.what == 'spread']
    )
    assert port.std() / 1e4 == pytest.approx(0.2, rel=0.15)
    assert tension.std() / 160e3 == pytest.approx(0.01, rel=0.15)
    # As in the survey: scatter of what is near, and how much is a period of the ranging too long.
    near = spread[np.abs(spread - np.median(spread)) <= 1.5]
    bias = load_instruments().door.spread.model().bias_std
    assert 0.2822 <= near.std() <= 0.4525
    assert 0.01704 <= np.mean(spread > np.median(spread) + 100.0) <= 0.1957
    assert math.isclose(near.mean(), 120.0, abs_tol=3.0 * bias)
