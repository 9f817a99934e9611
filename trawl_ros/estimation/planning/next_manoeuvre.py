"""Next manoeuvre: the most informative one from the present state of a fit."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.fit.fit import Fit
from trawl_ros.estimation.fit.laws import (
    LawQuantities,
    WorkingAngles,
    law_quantities,
    law_spans,
    working_angles,
)
from trawl_ros.estimation.fit.linearised import Linearised
from trawl_ros.estimation.planning.advice import Advice, RankedManoeuvre
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
    faster,
)
from trawl_ros.estimation.planning.windows import imagined_windows
from trawl_ros.estimation.windows.records import WindowOptions
from trawl_ros.gear.records import GearRecord
from trawl_ros.records.channels import INPUTS
from trawl_ros.solver.predict import Predictor

_Known = Mapping[Manoeuvre, TowableManoeuvre]

STALE = 1.0
"""Departure of a coefficient, in std of the prior, from where a manoeuvre was looked up, beyond
which it is looked up anew."""


class Adviser:
    """Adviser on the next manoeuvre.

    Looking a manoeuvre up takes seconds, advising a fraction of one. So whoever has time to spare
    calls `look_up` again and again, for one manoeuvre at a time, and `advise` after each window:
    it chooses among those that are known by then. Those near to where the ship is come first: they
    are solved soonest, and are what she can get to. Slower than where the boards have lost their
    lift nothing is sought. One thread may look up while another one advises.

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
        self._solved: set[Manoeuvre] = set()
        # Replaced, never changed: who ranks does not wait for who looks up.
        self._known: _Known = {}

    @property
    def known(self) -> Mapping[Manoeuvre, TowableManoeuvre]:
        """Feasible manoeuvres among those solved so far."""
        return MappingProxyType(dict(self._known))

    @property
    def looked_up(self) -> float:
        """Share of all manoeuvres that have been solved, with this estimate or one before."""
        return 0.0 if self._explorer is None else len(self._solved) / len(self._explorer)

    def look_up(self, coefficients: FloatArray, near: Manoeuvre | None = None) -> bool:
        """Solve one more manoeuvre; False when there is none left.

        Parameters
        ----------
        coefficients
            The present estimate (12,). When it has moved too far from where manoeuvres were
            looked up, all are looked up anew, and meanwhile the old ones serve.
        near
            State in which the ship is; by default the middle of the limits.
        """
        explorer = self._explorer
        if explorer is None or self._moved(explorer.coefficients, coefficients):
            explorer = Explorer(self._predictor, coefficients, self._limits)
            self._explorer = explorer
            self._waiting = list(explorer.manoeuvres)
        if not self._waiting:
            return False
        here = near or self._middle()
        manoeuvre = min(self._waiting, key=here.distance)
        self._waiting.remove(manoeuvre)
        self._solved.add(manoeuvre)
        state = explorer.look_up(manoeuvre, list(self._known.values()))
        if isinstance(state, Refused):
            self._forget({manoeuvre, *self._slower(manoeuvre)})
        else:
            self._known = {**self._known, manoeuvre: state}
        return True

    def _middle(self) -> Manoeuvre:
        limits = self._limits
        length, speed = (v[len(v) // 2] for v in (limits.lengths, limits.speeds))
        return Manoeuvre(length, length, speed)

    def _slower(self, lost: Manoeuvre) -> set[Manoeuvre]:
        """Find those slower than a refused manoeuvre that could be towed faster."""
        if not any(faster(known, lost) for known in self._known):
            return set()
        return {other for other in self._waiting if faster(lost, other)}

    def _forget(self, refused: set[Manoeuvre]) -> None:
        self._solved |= refused
        self._waiting = [other for other in self._waiting if other not in refused]
        self._known = {one: state for one, state in self._known.items() if one not in refused}

    def advise(self, fit: Fit) -> Advice | None:
        """Advise after a fit's newest window; None before a window, or with nothing known.

        Of all manoeuvres that is chosen which gains most per minute, as a plan counts it.
        """
        known = self._known
        ranking = self._rank(fit, known)
        if not ranking:
            return None
        return replace(self._promise(fit, ranking[0].manoeuvre, known), ranking=ranking)

    def ranking(self, fit: Fit) -> tuple[RankedManoeuvre, ...]:
        """Rank the `known` manoeuvres by what they gain per minute, the best one first.

        The state of the newest window is not among them: as it goes on it gives no more windows.

        Parameters
        ----------
        fit
            Without a window the ranking is empty.
        """
        return self._rank(fit, self._known)

    def _rank(self, fit: Fit, known: _Known) -> tuple[RankedManoeuvre, ...]:
        if not fit.windows or not known:
            return ()
        question = _Question.of(fit, self._gear)
        now = covariance_from(informed := information_in(fit), fit.prior)
        before, log_before = shortfall(question.quantities(now)), np.linalg.slogdet(now)[1]
        timetable, here = self._timetable(known), manoeuvre_of(fit)
        ranked = []
        for manoeuvre, candidate in sorted(known.items()):
            if self._goes_on(here, manoeuvre):
                continue
            windows = expected_windows(fit, candidate, self._windows.max_windows_per_state)
            taught = information_of(windows, fit.prior, fit.options, fit.scales)
            then = covariance_from(informed + taught, fit.prior)
            minutes = _minutes(timetable, fit, manoeuvre)
            ranked.append(
                RankedManoeuvre(
                    manoeuvre,
                    minutes,
                    nats=float(0.5 * (log_before - np.linalg.slogdet(then)[1])),
                    rate=(before - shortfall(question.quantities(then))) / minutes,
                    tension=candidate.tension,
                    deepest=candidate.deepest,
                )
            )
        return tuple(sorted(ranked, key=lambda it: -it.rate))

    def _goes_on(self, here: Manoeuvre, manoeuvre: Manoeuvre) -> bool:
        metres, speed = 2.0 * self._windows.length_tolerance, self._windows.speed_tolerance
        return (
            abs(manoeuvre.port_length - here.port_length) <= metres
            and abs(manoeuvre.starboard_length - here.starboard_length) <= metres
            and abs(manoeuvre.speed - here.speed) <= speed
        )

    def promise(self, fit: Fit, manoeuvre: Manoeuvre) -> Advice:
        """Predict the gain of one of the `known` manoeuvres, by the fit itself.

        Parameters
        ----------
        fit
            With one window at least.
        manoeuvre
            The next manoeuvre.
        """
        return self._promise(fit, manoeuvre, self._known)

    def _promise(self, fit: Fit, manoeuvre: Manoeuvre, known: _Known) -> Advice:
        question = _Question.of(fit, self._gear)
        windows = expected_windows(fit, known[manoeuvre], self._windows.max_windows_per_state)
        now = fit.posterior.covariance
        then = replace(fit, windows=(*fit.windows, *windows)).posterior.covariance
        return Advice(
            manoeuvre=manoeuvre,
            minutes=_minutes(self._timetable(known), fit, manoeuvre),
            before=question.quantities(now),
            after=question.quantities(then),
            nats=float(0.5 * (np.linalg.slogdet(now)[1] - np.linalg.slogdet(then)[1])),
            looked_up=self.looked_up,
            windows=len(fit.windows),
        )

    def _timetable(self, known: _Known) -> Timetable:
        ability = ability_of(self._gear, tuple(known))
        return Timetable(ability, self._windows, known.values())

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
    """Time from a fit's newest window, which may lack a reading, until those of a manoeuvre."""
    newest = fit.windows[-1]
    depth = newest.window.means.get('net_depth', float(newest.state.observables.net_depth))
    return minutes_of(timetable.legs((manoeuvre_of(fit), manoeuvre), depth)[1:])


def manoeuvre_of(fit: Fit) -> Manoeuvre:
    """Warp lengths and speed of a fit's newest window."""
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
