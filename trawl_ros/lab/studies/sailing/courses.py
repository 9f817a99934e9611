"""Courses of a trial with one board: sailed by the trial's own choice, or as they were planned."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from trawl_ros.control.trial.choice import choose
from trawl_ros.control.trial.memory import TowedState
from trawl_ros.control.trial.records import TrialSettings, TrialTarget
from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import NoSteadyState
from trawl_ros.estimation.fit.estimator import Estimator
from trawl_ros.estimation.from_gear import board_prior, predictor_for
from trawl_ros.estimation.planning.duration import Leg, holding_time
from trawl_ros.estimation.planning.next_manoeuvre import Adviser
from trawl_ros.estimation.planning.plan import question_for
from trawl_ros.estimation.planning.proposals import knowledge_of
from trawl_ros.estimation.planning.search import Designer
from trawl_ros.estimation.planning.states import Explorer, Manoeuvre, explore
from trawl_ros.estimation.windows.records import SteadyWindow, WindowOptions
from trawl_ros.gear.records import GearRecord
from trawl_ros.lab.studies.identification.plant import Look
from trawl_ros.lab.studies.identification.readings import AS_STATED, steady_windows
from trawl_ros.model.gear_model import build_model
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.solver.equilibrium import Equilibrium, find_usable
from trawl_ros.solver.operating_point import OperatingPoint
from trawl_ros.solver.sensitivity import sensitivities

START = Manoeuvre(500.0, 500.0, 2.1)
"""State in which a trial that runs itself is started."""


@dataclass(frozen=True)
class TowedLook(Look):
    """Steady state of the plant with warps of unequal length."""

    manoeuvre: Manoeuvre

    @property
    def inputs(self) -> tuple[float, float, float]:
        """Port and starboard warp length (m) and speed (m/s)."""
        towed = self.manoeuvre
        return towed.port_length, towed.starboard_length, towed.speed


class Sea:
    """Sea with one board in it: windows of the states in which it is towed.

    Parameters
    ----------
    gear
        The plant.
    seed
        Of the readings' errors: calibration of the one tow, and noise.
    """

    def __init__(self, gear: GearRecord, seed: Sequence[int]) -> None:
        self._model = build_model(gear)
        self._seed = list(seed)
        self._looks: dict[Manoeuvre, TowedLook | None] = {}
        self._found: dict[Manoeuvre, Equilibrium] = {}
        self._number = WindowOptions().max_windows_per_state

    def look(self, manoeuvre: Manoeuvre) -> TowedLook | None:
        """Tow in a state; None where the board cannot be towed."""
        if manoeuvre not in self._looks:
            self._looks[manoeuvre] = self._towed(manoeuvre)
        return self._looks[manoeuvre]

    def _towed(self, manoeuvre: Manoeuvre) -> TowedLook | None:
        lengths = manoeuvre.port_length, manoeuvre.starboard_length
        # As a plan and an adviser look it up: some are found from a neighbour alone.
        near = min(self._found, key=manoeuvre.distance, default=None)
        start = None if near is None else self._found[near]
        try:
            point = OperatingPoint(*lengths, manoeuvre.speed)
            steady = find_usable(self._model, point, start).equilibrium
        except NoSteadyState:
            return None
        self._found[manoeuvre] = steady
        jacobian = sensitivities(self._model, steady)
        state = manoeuvre.length, manoeuvre.speed
        values = steady.observables.array()
        return TowedLook(state, values, jacobian[:, 12:], jacobian[:, :12], manoeuvre)

    def windows(self, looks: Sequence[TowedLook]) -> tuple[SteadyWindow, ...]:
        """Windows of states, one after the other; those of the first ones are always the same."""
        repeated = [look for look in looks for _ in range(self._number)]
        drawn = steady_windows([repeated], AS_STATED, np.random.default_rng(self._seed))
        return tuple(replace(window, state=window.index // self._number) for window in drawn)


@dataclass(frozen=True)
class Course:
    """Course of a trial: the states towed, the hours, and the std (12,) of the coefficients."""

    states: tuple[str, ...]
    refused: int
    hours: float
    std: FloatArray

    @property
    def mean_std(self) -> float:
        """Geometric mean of the std."""
        return float(np.exp(np.mean(np.log(self.std))))


def planned_course(sea: Sea, gear: GearRecord, legs: Sequence[Leg]) -> Course:
    """Tow the legs of a plan, and fit all their windows."""
    looks = [look for leg in legs if (look := sea.look(leg.manoeuvre)) is not None]
    estimator = _estimator(gear)
    for window in sea.windows(looks):
        estimator.add(window)
    hours = sum(leg.total_minutes for leg in legs) / 60.0
    return _course(estimator, looks, len(legs) - len(looks), hours)


def known_course(sea: Sea, gear: GearRecord, coefficients: FloatArray, hours: float) -> Course:
    """Tow what would be planned if the board (12,) were known beforehand.

    A choice on the way knows less. It is no bound on its std all the same: the search for a plan
    weighs how well each law is known.
    """
    choice = explore(Explorer(predictor_for(gear), coefficients))
    question = question_for(gear, choice, coefficients, hours=hours)
    return planned_course(sea, gear, Designer(question, choice.candidates).best())


def sailed_course(
    sea: Sea, gear: GearRecord, hours: float, on_state: Callable[[str], None]
) -> Course:
    """Sail a trial as `trial_node` does: the estimator's best proposal that is allowed.

    All manoeuvres are looked up before each choice, for which there is time at sea. A state costs
    the minutes that were expected of it; one in which the board cannot be towed costs them too.
    """
    settings = TrialSettings(hours=hours)
    estimator, adviser = _estimator(gear), Adviser(gear, predictor_for(gear))
    looks: list[TowedLook] = []
    towed: list[TowedState] = []
    struck: list[TrialTarget] = []
    here, minutes, windows = START, holding_time(START, WindowOptions()) / 60.0, 0
    while True:
        on_state(f'{here}, after {minutes:.0f} min')
        target = TrialTarget(
            port=here.port_length, starboard=here.starboard_length, speed=here.speed
        )
        look = sea.look(here)
        if look is None:
            struck.append(target)
        else:
            looks.append(look)
            all_windows = sea.windows(looks)
            for window in all_windows[windows:]:
                estimator.add(window)
            windows = len(all_windows)
            towed.append(TowedState(target=target, windows=2))
        while adviser.look_up(estimator.coefficients, here):
            pass
        choice = choose(
            knowledge_of(adviser.advise(estimator.fit), windows).proposals,
            settings,
            here=target,
            towed=towed,
            struck=struck,
            minutes_left=60.0 * hours - minutes,
        )
        if choice.proposal is None:
            return _course(estimator, looks, len(struck), minutes / 60.0)
        chosen = choice.proposal
        minutes += chosen.minutes
        here = Manoeuvre(chosen.target.port, chosen.target.starboard, chosen.target.speed)


def _estimator(gear: GearRecord) -> Estimator:
    return Estimator(predictor_for(gear), board_prior(gear), OBSERVABLES)


def _course(estimator: Estimator, looks: Sequence[TowedLook], refused: int, hours: float) -> Course:
    estimate = estimator.finish() if estimator.windows else None
    # A board that can be towed in none of the states teaches nothing.
    std = estimator.prior.std if estimate is None else estimate.std
    states = tuple(str(look.manoeuvre) for look in looks)
    return Course(states, refused, hours, np.array(std))
