"""Next manoeuvre: the most informative one from the present state of a fit."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.fit.fit import Fit
from trawl_ros.estimation.fit.laws import (
    QUANTITIES,
    WELL_KNOWN,
    LawQuantities,
    WorkingAngles,
    law_quantities,
    law_spans,
    working_angles,
)
from trawl_ros.estimation.fit.linearised import Linearised
from trawl_ros.estimation.planning.duration import Timetable, ability_of, minutes_of
from trawl_ros.estimation.planning.information import (
    covariance_from,
    information_in,
    information_of,
)
from trawl_ros.estimation.planning.search import shortfall
from trawl_ros.estimation.planning.states import (
    Explorer,
    Limits,
    Manoeuvre,
    Refused,
    TowableManoeuvre,
)
from trawl_ros.estimation.planning.windows import imagined_windows
from trawl_ros.estimation.windows.records import WindowOptions
from trawl_ros.gear.records import GearRecord
from trawl_ros.records.channels import INPUTS
from trawl_ros.solver.predict import Predictor

STALE = 1.0
"""Departure of a coefficient, in std of the prior, from where a manoeuvre was looked up, beyond
which it is looked up anew."""


@dataclass(frozen=True)
class Advice:
    """Advice: the next manoeuvre and its gain.

    Attributes
    ----------
    manoeuvre
        Warp lengths and speed; the ship goes straight ahead.
    minutes
        From now until its windows are taken.
    before, after
        Quantities of the laws now, and then.
    nats
        Information gained: half the fall of the covariance's log determinant.
    looked_up
        Part of all manoeuvres among which was chosen; the others are not looked up yet.
    """

    manoeuvre: Manoeuvre
    minutes: float
    before: LawQuantities
    after: LawQuantities
    nats: float
    looked_up: float

    @property
    def helped(self) -> int:
        """Index into `QUANTITIES` of the quantity that improves most."""
        terms = [np.log1p((known.ratio / WELL_KNOWN) ** 2) for known in (self.before, self.after)]
        return int(np.argmax(terms[0] - terms[1]))

    def __str__(self) -> str:
        at = self.helped
        return (
            f'{self.manoeuvre}, {self.minutes:g} min: {QUANTITIES[at]} from '
            f'{100 * self.before.ratio[at]:.0f} to {100 * self.after.ratio[at]:.0f} % of its span, '
            f'{self.before.well_known.sum()} to {self.after.well_known.sum()} of '
            f'{len(QUANTITIES)} well known'
        )


class Adviser:
    """Adviser on the next manoeuvre.

    Looking a manoeuvre up takes seconds, advising a fraction of one. So whoever has time to spare
    calls `look_up` again and again, for one manoeuvre at a time, and `advise` after each window:
    it chooses among those that are known by then.

    Parameters
    ----------
    gear
        From `load_gear`.
    predictor
        Its model.
    limits
        Among which manoeuvres one may choose.
    windows
        Criteria of a steady window.
    """

    def __init__(
        self,
        gear: GearRecord,
        predictor: Predictor,
        limits: Limits | None = None,
        windows: WindowOptions | None = None,
    ) -> None:
        self._gear = gear
        self._predictor = predictor
        self._windows = windows or WindowOptions()
        self._scale = np.array(gear.identification.std)
        self._limits = limits or Limits()
        self._explorer: Explorer | None = None
        self._waiting: list[Manoeuvre] = []
        self._known: dict[Manoeuvre, TowableManoeuvre] = {}

    @property
    def known(self) -> Mapping[Manoeuvre, TowableManoeuvre]:
        """Feasible manoeuvres among those solved so far."""
        return MappingProxyType(self._known)

    @property
    def looked_up(self) -> float:
        """Share of all manoeuvres that have been solved."""
        return 0.0 if self._explorer is None else 1.0 - len(self._waiting) / len(self._explorer)

    def look_up(self, coefficients: FloatArray) -> bool:
        """Solve one more manoeuvre; False when there is none left.

        Parameters
        ----------
        coefficients
            The present estimate (12,). When it has moved too far from where manoeuvres were
            looked up, all are looked up anew, and meanwhile the old ones serve.
        """
        explorer = self._explorer
        if explorer is None or self._moved(explorer.coefficients, coefficients):
            explorer = Explorer(self._predictor, coefficients, self._limits)
            self._explorer = explorer
            self._waiting = list(explorer.manoeuvres)
        if not self._waiting:
            return False
        manoeuvre = self._waiting.pop(0)
        state = explorer.look_up(manoeuvre, list(self._known.values()))
        if isinstance(state, Refused):
            self._known.pop(manoeuvre, None)
        else:
            self._known[manoeuvre] = state
        return True

    def advise(self, fit: Fit) -> Advice | None:
        """Advise after a fit's newest window; None before a window, or with nothing known.

        Of all manoeuvres that is chosen which gains most per minute, as a plan counts it.
        """
        if not fit.windows or not self._known:
            return None
        question = _Question.of(fit, self._gear)
        before = shortfall(question.quantities(fit.posterior.covariance))
        information = information_in(fit)
        timetable = self._timetable()
        best, most = None, -np.inf
        for manoeuvre, candidate in sorted(self._known.items()):
            windows = expected_windows(fit, candidate, self._windows.max_windows_per_state)
            taught = information_of(windows, fit.prior, fit.options, fit.scales)
            after = shortfall(question.quantities(covariance_from(information + taught, fit.prior)))
            rate = (before - after) / _minutes(timetable, fit, manoeuvre)
            if rate > most:
                best, most = manoeuvre, rate
        return None if best is None else self.promise(fit, best)

    def promise(self, fit: Fit, manoeuvre: Manoeuvre) -> Advice:
        """Predict the gain of one of the `known` manoeuvres, by the fit itself.

        Parameters
        ----------
        fit
            With one window at least.
        manoeuvre
            The next manoeuvre.
        """
        question = _Question.of(fit, self._gear)
        number = self._windows.max_windows_per_state
        windows = expected_windows(fit, self._known[manoeuvre], number)
        now = fit.posterior.covariance
        then = replace(fit, windows=(*fit.windows, *windows)).posterior.covariance
        return Advice(
            manoeuvre=manoeuvre,
            minutes=_minutes(self._timetable(), fit, manoeuvre),
            before=question.quantities(now),
            after=question.quantities(then),
            nats=float(0.5 * (np.linalg.slogdet(now)[1] - np.linalg.slogdet(then)[1])),
            looked_up=self.looked_up,
        )

    def _timetable(self) -> Timetable:
        ability = ability_of(self._gear, tuple(self._known))
        return Timetable(ability, self._windows, self._known.values())

    def _moved(self, before: FloatArray, now: FloatArray) -> bool:
        return bool(np.max(np.abs(now - before) / self._scale) > STALE)


def expected_windows(fit: Fit, candidate: TowableManoeuvre, number: int) -> tuple[Linearised, ...]:
    """Predicted windows of a manoeuvre in a fit's newest tow, at its noise."""
    newest = fit.windows[-1].window
    imagined = imagined_windows(
        candidate,
        fit.coefficients,
        state=1 + max(linear.window.state for linear in fit.windows),
        number=number,
        tow=newest.tow,
        noise=_noise_of(fit),
    )
    first = 1 + max(linear.window.index for linear in fit.windows)
    return tuple(
        replace(linear, window=replace(linear.window, index=first + index))
        for index, linear in enumerate(imagined)
    )


def _noise_of(fit: Fit) -> Mapping[str, float]:
    """Median standard error of each channel with readings, over the windows of the newest tow."""
    tow = fit.windows[-1].window.tow
    windows = [linear.window for linear in fit.windows if linear.window.tow == tow]
    heard = {*INPUTS, *(name for linear in fit.windows for name in linear.channels)}
    return {
        name: float(np.median([window.noise[name] for window in windows if name in window.noise]))
        for name in sorted(heard)
        if 2 * sum(name in window.noise for window in windows) >= len(windows)
    }


def _minutes(timetable: Timetable, fit: Fit, manoeuvre: Manoeuvre) -> float:
    """Time from a fit's newest window until those of a manoeuvre are taken."""
    depth = fit.windows[-1].window.means['net_depth']
    return minutes_of(timetable.legs((_manoeuvre_of(fit), manoeuvre), depth)[1:])


def _manoeuvre_of(fit: Fit) -> Manoeuvre:
    means = fit.windows[-1].window.means
    return Manoeuvre(*(float(means[name]) for name in INPUTS))


@dataclass(frozen=True)
class _Question:
    """Laws at the angles at which the fit's windows found the boards.

    They are measured by what they were expected to span before any tow: by the span of the
    estimate, a law that turns out to have no slope could never be known well.
    """

    coefficients: FloatArray
    angles: WorkingAngles
    span: FloatArray

    @classmethod
    def of(cls, fit: Fit, gear: GearRecord) -> '_Question':
        observables = [linear.state.observables for linear in fit.windows]
        return cls(
            fit.coefficients,
            working_angles(observables, gear.board.slip_sign),
            law_spans(fit.prior.start, fit.prior.std),
        )

    def quantities(self, covariance: FloatArray) -> LawQuantities:
        return law_quantities(self.coefficients, covariance, self.angles, self.span)
