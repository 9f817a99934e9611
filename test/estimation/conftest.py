"""A closed-form gear with a known answer, and tows of it as streams of samples."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from trawl_ros.core.errors import NoSteadyState
from trawl_ros.estimation.fit.estimator_options import EstimatorOptions
from trawl_ros.estimation.fit.laws import WorkingAngles, law_quantities
from trawl_ros.estimation.fit.parameters import ParameterGroup, ParameterVector
from trawl_ros.estimation.from_gear import board_prior
from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.gear.board_parameters import (
    EQ14,
    STALL,
    CoefficientsRecord,
    StartRecord,
)
from trawl_ros.gear.boards import BoardLawRecord, BoardRecord, PolarPointRecord, TiltPointRecord
from trawl_ros.gear.load import load_gear
from trawl_ros.gear.polars import polar_of
from trawl_ros.gear.records import GearRecord
from trawl_ros.model.gear_model import build_model
from trawl_ros.records.channels import CHANNELS, INPUTS
from trawl_ros.records.observables import OBSERVABLES as GEAR_OBSERVABLES
from trawl_ros.records.samples import (
    AttitudeSample,
    HeadingSample,
    PressureSample,
    RangeSample,
    Sample,
    VelocitySample,
    WinchSample,
)
from trawl_ros.solver.predict import Predictor

NANO = 1_000_000_000
EPOCH = 1_750_000_000 * NANO
OBSERVABLES = (
    'door_spread', 'port_door_depth', 'starboard_door_depth', 'port_tension',
    'starboard_tension', 'net_depth', 'port_pitch', 'starboard_pitch', 'port_roll',
    'starboard_roll', 'vertical_opening', 'horizontal_opening',
)  # fmt: skip
TRUTH = np.array([1.19, 0.041, 2.47, 0.67, -0.3, 0.01, -0.46, 0.02, 0.24, 0.016, 0.92, 0.25])
STD = 0.3 * np.abs(TRUTH) + 0.05
SLOW = np.array([name.endswith('depth') for name in OBSERVABLES], dtype=float)
"""The closed form comes to rest with doors and net sinking alike."""

SIZES = np.array([130, 200, 200, 2e5, 2e5, 220, 0.2, 0.2, 0.2, 0.2, 40, 100.0])


@dataclass(frozen=True)
class Answer:
    values: np.ndarray
    jacobian: np.ndarray
    slow: np.ndarray
    state: Any = None


@dataclass
class ClosedForm:
    """Observables y = size (1 + p + 0.02 p² + inputs), p linear in scaled coefficients.

    The sensitivities p = (S0 + S1 l + S2 u) z vary with warp length l and speed u, as they do
    in a real gear, so that a trial of several lengths and speeds has a definite answer.
    ``stops_at``: no steady state where the first coefficient is beyond this.
    """

    sensitivity: np.ndarray = field(
        default_factory=lambda: 0.1 * np.random.default_rng(3).normal(size=(12, 12, 3))
    )
    stops_at: float = math.inf
    calls: int = 0

    def predict(
        self,
        coefficients: np.ndarray,
        port_length: float,
        starboard_length: float,
        speed: float,
        start: Any = None,
    ) -> Answer:
        self.calls += 1
        if coefficients[0] > self.stops_at:
            raise NoSteadyState('the closed form has no steady state there')
        z = (coefficients - TRUTH) / STD
        length, fast = (port_length + starboard_length) / 1000.0 - 1.0, speed / 2.0 - 1.0
        by_z = self.sensitivity @ np.array([1.0, length, fast])
        p = by_z @ z
        slope = SIZES * (1.0 + 0.04 * p)
        values = SIZES * (1.0 + p + 0.02 * p**2 + 0.4 * length + 0.5 * fast)
        by_length = (slope * (self.sensitivity[:, :, 1] @ z) + 0.4 * SIZES) / 1000.0
        by_speed = (slope * (self.sensitivity[:, :, 2] @ z) + 0.5 * SIZES) / 2.0
        jacobian = np.column_stack((slope[:, None] * by_z / STD, by_length, by_length, by_speed))
        return Answer(values, jacobian, SLOW)


def pressure_to_depth(pressure: float) -> float:
    return (pressure - 101_325.0) / (1025.0 * 9.81)


def depth_to_pressure(depth: float) -> float:
    return 101_325.0 + 1025.0 * 9.81 * depth


@dataclass(frozen=True)
class Leg:
    """Warp length (m) and speed (m/s) wanted, and for how long (s) after getting there."""

    length: float
    speed: float
    seconds: float = 300.0
    turn: float = 0.0


def tow(
    model: ClosedForm,
    legs: Sequence[Leg],
    seed: int = 0,
    lag_s: float = 25.0,
    noise: float = 1.0,
    coefficients: np.ndarray = TRUTH,
) -> list[Sample]:
    """Tow legs one after another at 1 Hz; the gear follows its steady state with a lag."""
    rng = np.random.default_rng(seed)
    length, speed, heading = legs[0].length, legs[0].speed, 3.0
    state: np.ndarray | None = None
    samples: list[Sample] = []
    second = 0

    def scatter(name: str, size: float = 1.0) -> float:
        return noise * size * CHANNELS[name].noise * float(rng.normal())

    for leg in legs:
        left = leg.seconds
        while left > 0:
            length += float(np.clip(leg.length - length, -1.0, 1.0))
            speed += float(np.clip(leg.speed - speed, -0.02, 0.02))
            heading += leg.turn
            left -= length == leg.length and abs(speed - leg.speed) < 1e-9
            wanted = model.predict(coefficients, length, length, speed).values
            state = wanted if state is None else state + (wanted - state) / lag_s
            y = dict(zip(OBSERVABLES, state, strict=True))
            stamp = EPOCH + second * NANO
            counters = [length + scatter('port_length', 0.5) for _ in range(2)]
            cells = [y[f'{side}_tension'] + scatter('port_tension') for side in SIDES]
            samples.append(WinchSample(stamp, tuple(counters), (0.0, 0.0), tuple(cells)))
            velocity = np.array([speed + scatter('speed', 0.5), 0.0, 0.0])
            samples.append(VelocitySample(stamp, 'water', velocity, leg.turn))
            wrapped = math.remainder(heading + scatter('heading', 0.5), 2 * math.pi)
            samples.append(HeadingSample(stamp, wrapped, 0.01))
            depth = y['net_depth'] + scatter('net_depth')
            samples.append(PressureSample(stamp, 'sonar', depth_to_pressure(depth), 3000.0))
            if second % 3 == 0:
                for side in SIDES:
                    depth = y[f'{side}_door_depth'] + scatter('port_door_depth')
                    pressure = depth_to_pressure(depth)
                    samples.append(PressureSample(stamp + 1000, side, pressure, 3000.0))
                    pitch = y[f'{side}_pitch'] + scatter('port_pitch')
                    roll = y[f'{side}_roll'] + scatter('port_roll')
                    samples.append(AttitudeSample(stamp + 2000, side, pitch, roll, 0.017))
                spread = y['door_spread'] + scatter('door_spread')
                samples.append(RangeSample(stamp + 3000, 'spread', spread, 1.0, 1.0, 500.0))
            second += 1
    return samples


SIDES = ('port', 'starboard')


def trial_windows(
    model: ClosedForm, rng: np.random.Generator, noise: float = 1.0, repeats: int = 1
) -> list[SteadyWindow]:
    """One tow of five warp lengths at three speeds, wrong as the channel table says.

    Calibration is wrong throughout; ``noise`` is a factor on what differs between windows, for
    warp lengths and speed 1 at most.
    """
    shares = EstimatorOptions()
    drawn = {name: rng.normal(size=2) for name in sorted(CHANNELS)}
    found = []

    def noise_of(name: str) -> float:
        return min(noise, 1.0) if name in INPUTS else noise

    for speed in (1.8, 2.0, 2.2):
        for length in (200.0, 375.0, 550.0, 725.0, 900.0):
            for _ in range(repeats):
                values = model.predict(TRUTH, length, length, speed).values
                exact = {'port_length': length, 'starboard_length': length, 'speed': speed}
                seen = zip(OBSERVABLES, values, strict=True)
                exact |= {name: value for name, value in seen if name in CHANNELS}
                means = {}
                for name, value in exact.items():
                    channel = CHANNELS[name]
                    sizes = np.array([channel.bias, channel.bias_fraction * value])
                    calibration = shares.tow_share * float(sizes @ drawn[name])
                    state_std = channel.state_std(channel.bias_std(value), shares.state_share)
                    own = state_std * float(rng.normal())
                    means[name] = value + noise_of(name) * own + bool(noise) * calibration
                index = len(found)
                found.append(
                    SteadyWindow(
                        index=index,
                        state=index,
                        start_ns=EPOCH + index * 300 * NANO,
                        end_ns=EPOCH + index * 300 * NANO + 90 * NANO,
                        means=means,
                        noise=dict.fromkeys(exact, 0.0),
                        bias={n: CHANNELS[n].bias_std(value) for n, value in exact.items()},
                        counts=dict.fromkeys(exact, 90),
                    )
                )
    return found


@pytest.fixture
def model() -> ClosedForm:
    return ClosedForm()


@pytest.fixture
def prior() -> ParameterVector:
    board = ParameterGroup('coefficients', EQ14.names, EQ14.units)
    low, high = TRUTH - 4.0 * STD, TRUTH + 4.0 * STD
    return ParameterVector(TRUTH + 0.7 * STD, STD, low, high, (board,))


@pytest.fixture
def sea() -> SimpleNamespace:
    """What the tests need of this file."""
    return SimpleNamespace(
        NANO=NANO,
        EPOCH=EPOCH,
        OBSERVABLES=OBSERVABLES,
        TRUTH=TRUTH,
        STD=STD,
        ClosedForm=ClosedForm,
        Leg=Leg,
        tow=tow,
        trial_windows=trial_windows,
        pressure_to_depth=pressure_to_depth,
        depth_to_pressure=depth_to_pressure,
    )


def straight_with_heel(board: BoardRecord) -> BoardRecord:
    """A board on straight lines, as eq. 14, whose lift falls as it heels; alike at 16°."""
    polar = polar_of(board)
    assert polar is not None
    angles = np.radians([12.0, 20.0])
    lines = [
        np.polyfit(angles, np.interp(angles, polar.attack, own), 1)
        for own in (polar.lift, polar.drag)
    ]
    points = tuple(
        PolarPointRecord(
            attack_deg=angle,
            lift=float(np.polyval(lines[0], np.radians(angle))),
            drag=max(float(np.polyval(lines[1], np.radians(angle))), 0.0),
        )
        for angle in (0.0, 10.0, 20.0, 30.0, 40.0)
    )
    heel = tuple(
        TiltPointRecord(tilt_deg=tilt, lift_factor=factor, upward=upward)
        for tilt, factor, upward in ((-20.0, 0.85, -0.5), (0.0, 1.0, 0.0), (20.0, 0.85, 0.5))
    )
    law = BoardLawRecord(kind='table', points=points, heel=heel)
    return board.model_copy(update={'law': law})


@dataclass(frozen=True)
class BoardOfLaw:
    """A coarse gear whose boards follow a law, the truth of its parameters, and states to tow in.

    ``well_known`` are parameters of which the readings tell far more than the prior. A fit has
    ``model``, and its readings are from ``plant``, whose mesh is finer.
    """

    gear: GearRecord
    model: GearRecord
    plant: GearRecord
    truth: dict[str, float]
    states: tuple[tuple[float, float], ...]
    well_known: tuple[str, ...]

    @property
    def values(self) -> np.ndarray:
        """True values in the order of the law."""
        return np.array([self.truth.get(n, 0.0) for n in self.gear.board.parameters.names])

    def lift(self, values: np.ndarray, covariance: np.ndarray) -> tuple[float, float]:
        """Lift at 16° of attack, where the boards work, and its std."""
        angles, law = WorkingAngles(np.radians(16.0), 0.0), build_model(self.gear).board.law
        known = law_quantities(law, values, covariance, angles)
        return float(known.values[1]), float(known.sd[1])


OTHER_BOARD_STATES = (
    (300.0, 1.9), (300.0, 2.1), (300.0, 2.3), (400.0, 2.3), (400.0, 2.1), (400.0, 1.9),
    (500.0, 1.9), (500.0, 2.1), (500.0, 2.3),
)  # fmt: skip
TABLED_STATES = (
    (300.0, 1.4), (300.0, 1.2), (450.0, 1.3), (600.0, 1.2), (600.0, 1.4), (800.0, 1.3),
)  # fmt: skip
STALLING = {
    'lift_slope': 2.6, 'zero_lift_angle': -0.26, 'stall_angle': 0.40, 'plate_lift': 0.9,
    'base_drag': 0.1, 'induced_drag': 0.23, 'centre_ahead': -0.35, 'span_force_slope': -0.2,
    'roll_slope': -0.46, 'roll': 0.02, 'pitch_slope': 0.22,
}  # fmt: skip

BELIEVED_OF_STALLING = {'centre_ahead': -0.3, 'roll_slope': -0.4, 'pitch_slope': 0.15}
"""Start values; with other moments the boards do not stay upright in this rigging."""


@pytest.fixture(params=['foil', 'tilted table', 'heel', 'stall'])
def board_of_law(request: pytest.FixtureRequest) -> BoardOfLaw:
    """Boards of a foil or table with hidden corrections, or of a law with own parameters."""
    kind = request.param
    if kind in ('foil', 'tilted table'):
        # More drag and more lift than the table says.
        gear, hidden = load_gear('krill_800').refined(net=0.4), {'c1': 0.04, 'c2': 0.12}
        if kind == 'tilted table':
            gear = gear.model_copy(update={'board': straight_with_heel(gear.board)})
        return BoardOfLaw(gear, gear, gear, hidden, TABLED_STATES, ())
    gear = load_gear('kaifuha').refined(net=0.25)
    truth, known = STALLING, ('stall_angle', 'induced_drag', 'centre_ahead')
    usual = STALL.prior
    assert usual is not None
    believed = STALL.start | BELIEVED_OF_STALLING
    prior = usual.model_copy(update={'start': tuple(believed.values())})
    if kind == 'heel':
        own = zip(('start', 'std', 'low', 'high'), (0.0, 0.3, -2.0, 2.0), strict=True)
        truth = gear.board.coefficients.model_dump() | {'h2': -0.4, 'h3': 0.3}
        lists = {key: (*getattr(gear.identification, key), *(more,) * 2) for key, more in own}
        prior, known = StartRecord(**lists), ('a2', 'c2', 'h2', 'h3')
    parts = {'law': BoardLawRecord(kind=kind), 'coefficients': CoefficientsRecord(**truth)}
    board = gear.board.model_copy(update=parts)
    gear = gear.model_copy(update={'board': board, 'identification': prior})
    model, plant = gear.refined(net=2), gear.refined(net=4, warp=2, bridle=2)
    return BoardOfLaw(gear, model, plant, truth, OTHER_BOARD_STATES, known)


TOW_STATES = ((450.0, 2.1, 0.3), (300.0, 2.1, 0.3), (300.0, 2.3, 1.9))
"""Warp length (m), speed (m/s) and heading (rad)."""

LEG_S = 220

CURRENT = np.array([-0.118, 0.382])
"""East and north (m/s): across the first heading."""


class Linear:
    """A gear around some states that were solved, each with its sensitivities."""

    def __init__(self, gear: GearRecord) -> None:
        predictor, start = Predictor(build_model(gear)), np.array(gear.identification.start)
        self.points, self.found = [], []
        for length, speed, _ in TOW_STATES:
            state = self.found[-1].state if self.found else None
            self.found.append(predictor.predict(start, length, length, speed, state))
            self.points.append(np.array([*start, length, length, speed]))

    def predict(
        self,
        coefficients: np.ndarray,
        port_length: float,
        starboard_length: float,
        speed: float,
        start: Any = None,
    ) -> Answer:
        point = np.array([*coefficients, port_length, starboard_length, speed])
        off = [np.hypot((port_length - p[12]) / 100.0, (speed - p[14]) / 0.1) for p in self.points]
        nearest = int(np.argmin(off))
        found = self.found[nearest]
        values = found.values + found.jacobian @ (point - self.points[nearest])
        return Answer(values, found.jacobian, found.slow, nearest)


@pytest.fixture(scope='session')
def clean_tow(coarse_gear: Path) -> SimpleNamespace:
    """A tow of the coarse gear, its model around the states of the tow, and what is known."""
    gear = load_gear(coarse_gear)
    linear, prior = Linear(gear), board_prior(gear)
    return SimpleNamespace(
        prior=prior,
        linear=linear,
        depth=build_model(gear).water.depth,
        samples=list(clean_samples(linear, prior, build_model(gear).water.pressure)),
    )


def clean_samples(
    linear: Linear, prior: ParameterVector, pressure: Callable[[float], float]
) -> Iterator[Sample]:
    """A tow through all states in a current, with the noise of the default instruments."""
    draw = np.random.default_rng(4).standard_normal
    truth = prior.start + 0.3 * prior.std * np.where(np.arange(12) % 3, 1.0, -1.0)
    for second in range(LEG_S * len(TOW_STATES)):
        length, speed, heading = TOW_STATES[second // LEG_S]
        seen = linear.predict(truth, length, length, speed).values
        y = dict(zip(GEAR_OBSERVABLES, seen, strict=True))
        stamp = EPOCH + second * NANO
        yield HeadingSample(stamp, heading + 0.002 * draw(), 0.002)
        ground = speed * np.array([math.cos(heading), math.sin(heading)]) + CURRENT
        yield VelocitySample(stamp, 'ground', np.array([*(ground + 0.03 * draw(2)), 0.0]), math.nan)
        water = np.array([speed + 0.03 * draw(), 0.0, 0.0])
        yield VelocitySample(stamp, 'water', water, 0.0003 * draw())
        tensions = [y[f'{side}_tension'] + 1600.0 * draw() for side in SIDES]
        yield WinchSample(stamp, tuple(length + 0.05 * draw(2)), (0.0, 0.0), tuple(tensions))
        depths = {'sonar': y['net_depth']} | {side: y[f'{side}_door_depth'] for side in SIDES}
        for place, depth in depths.items():
            yield PressureSample(stamp, place, pressure(depth + 0.2 * draw()), 2000.0)
        if second % 2 == 0:
            for side in SIDES:
                pitch, roll = (y[f'{side}_{angle}'] + 0.009 * draw() for angle in ('pitch', 'roll'))
                yield AttitudeSample(stamp, side, pitch, roll, 0.009)
            yield RangeSample(stamp, 'spread', y['door_spread'] + 0.7 * draw(), 0.7, 5.0, 600.0)
        if second % 10 == 0:
            opening = y['vertical_opening'] + 0.1 * draw()
            yield RangeSample(stamp, 'opening_height', opening, 0.05, 1.0, 300.0)
