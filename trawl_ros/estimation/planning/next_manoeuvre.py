# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Next manoeuvre: the most informative one from the present state of a fit."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.fit.fit import Fit
from trawl_ros.estimation.planning.advice import Advice, RankedManoeuvre
from trawl_ros.estimation.planning.duration import Timetable, minutes_of, vessel_limits
from trawl_ros.estimation.planning.information import (
    covariance_from,
    information_in,
    information_of,
)
from trawl_ros.estimation.planning.law_question import LawQuestion
from trawl_ros.estimation.planning.search import shortfall
from trawl_ros.estimation.planning.states import (
    Explorer,
    Limits,
    Manoeuvre,
    Refused,
    TowableManoeuvre,
    faster,
)
from trawl_ros.estimation.planning.windows import expected_windows
from trawl_ros.estimation.windows.records import WindowOptions
from trawl_ros.gear.records import GearRecord
from trawl_ros.records.channels import INPUTS
from trawl_ros.solver.predict import Predictor

_Known = Mapping[Manoeuvre, TowableManoeuvre]

STALE = 1.0
"""Departure of a coefficient, in std of the prior, from where a manoeuvre was looked up, beyond
which it is looked up again."""


class Adviser:
    """Adviser on the next manoeuvre.

    Looking a manoeuvre up takes seconds, advising a fraction of one. So whoever has time to spare
    calls `look_up` again and again, for one manoeuvre at a time, and `advise` after each window:
    it chooses among those that are known by then. Those near to where the ship is come first: they
    are solved soonest, and are what she can get to. Slower than where the boards have lost their
    lift nothing is sought. An estimate by which the gear could not be towed where the ship tows it,
    or nowhere, is wrong: then those manoeuvres serve that an earlier one found. One thread may look
    up while another one advises.

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
        self._refused: Counter[str] = Counter()
        self._found: set[Manoeuvre] = set()
        # Replaced, never changed: who ranks does not wait for who looks up.
        self._known: _Known = {}
        self._before: _Known = {}
        self._doubted: FloatArray | None = None
        self._doubt = ''

    @property
    def known(self) -> Mapping[Manoeuvre, TowableManoeuvre]:
        """Feasible manoeuvres among those solved so far."""
        return MappingProxyType(dict(self._serving()))

    @property
    def trouble(self) -> str:
        """Sentence on an estimate that could not tow the gear; '' for none."""
        refused = dict(self._refused)
        if self._doubt or self._known or not refused:
            return self._doubt
        reasons = ', '.join(f'{reason} {number}' for reason, number in refused.items())
        earlier = f'; the {len(self._before)} of an earlier estimate serve' if self._before else ''
        return (
            f'by this estimate the gear can be towed in none of {sum(refused.values())} manoeuvres '
            f'({reasons}){earlier}'
        )

    def _serving(self) -> _Known:
        return self._known or self._before

    @property
    def looked_up(self) -> float:
        """Share of all manoeuvres that have been solved, with this estimate or one before."""
        return 0.0 if self._explorer is None else len(self._solved) / len(self._explorer)

    def look_up(self, coefficients: FloatArray, near: Manoeuvre | None = None) -> bool:
        """Solve one more manoeuvre; False when there is none left.

        Parameters
        ----------
        coefficients
            The present estimate (q,). When it has moved too far from where manoeuvres were
            looked up, all are looked up again, and meanwhile the old ones serve.
        near
            State in which the ship is; by default the middle of the limits.
        """
        explorer = self._explorer
        if explorer is None or self._moved(explorer.coefficients, coefficients):
            explorer = self._begun(coefficients, near)
        else:
            self._doubted, self._doubt = None, ''
        if not self._waiting:
            return False
        here = near or self._middle()
        manoeuvre = min(self._waiting, key=here.distance)
        self._waiting.remove(manoeuvre)
        self._solved.add(manoeuvre)
        state = explorer.look_up(manoeuvre, list(self._serving().values()))
        if isinstance(state, Refused):
            refused = {manoeuvre, *self._slower(manoeuvre)}
            self._refused[state.reason] += len(refused)
            self._forget(refused)
        else:
            self._found.add(manoeuvre)
            self._known = {**self._known, manoeuvre: state}
        return True

    def _begun(self, coefficients: FloatArray, near: Manoeuvre | None) -> Explorer:
        """Begin again with an estimate, unless it could not tow the gear as the ship does."""
        before = self._explorer
        explorer = Explorer(self._predictor, coefficients, self._limits)
        if before is not None and near is not None and self._known:
            if self._doubted is None or not np.array_equal(self._doubted, coefficients):
                self._doubted, self._doubt = np.array(coefficients), ''
                here = explorer.look_up(near, list(self._known.values()))
                if isinstance(here, Refused):
                    where = f'{near.length:.0f} m at {near.speed:.1f} m/s ({here.reason})'
                    self._doubt = (
                        f'by this estimate the gear could not be towed where it is, {where}; the '
                        f'{len(self._known)} manoeuvres of an earlier estimate serve'
                    )
            if self._doubt:
                return before
        self._explorer, self._doubted, self._doubt = explorer, None, ''
        self._waiting = list(explorer.manoeuvres)
        self._before = self._serving()
        self._found, self._refused = set(), Counter()
        return explorer

    def _middle(self) -> Manoeuvre:
        limits = self._limits
        length, speed = (v[len(v) // 2] for v in (limits.lengths, limits.speeds))
        return Manoeuvre(length, length, speed)

    def _slower(self, lost: Manoeuvre) -> set[Manoeuvre]:
        """Find those slower than a refused one that this estimate could tow faster."""
        if not any(faster(found, lost) for found in self._found):
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
        known = self._serving()
        ranking = self._rank(fit, known)
        if not ranking:
            return None
        return replace(self._promise(fit, ranking[0].manoeuvre, known), ranking=ranking)

    def _rank(self, fit: Fit, known: _Known) -> tuple[RankedManoeuvre, ...]:
        """Rank manoeuvres by what they gain per minute, the best one first.

        The state of the newest window is not among them: as it goes on it gives no more windows.
        """
        if not fit.windows or not known:
            return ()
        question = LawQuestion.of(fit, self._predictor.model.board.law)
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

    def _promise(self, fit: Fit, manoeuvre: Manoeuvre, known: _Known) -> Advice:
        """Predict the gain of a known manoeuvre, by the fit itself."""
        question = LawQuestion.of(fit, self._predictor.model.board.law)
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
        vessel = vessel_limits(self._gear, tuple(known))
        return Timetable(vessel, self._windows, known.values())

    def _moved(self, before: FloatArray, now: FloatArray) -> bool:
        return bool(np.max(np.abs(now - before) / self._scale) > STALE)


def _minutes(timetable: Timetable, fit: Fit, manoeuvre: Manoeuvre) -> float:
    """Time from a fit's newest window, which may lack a reading, until those of a manoeuvre."""
    newest = fit.windows[-1]
    depth = newest.window.means.get('net_depth', float(newest.state.observables.net_depth))
    return minutes_of(timetable.legs((manoeuvre_of(fit), manoeuvre), depth)[1:])


def manoeuvre_of(fit: Fit) -> Manoeuvre:
    """Warp lengths and speed of a fit's newest window."""
    means = fit.windows[-1].window.means
    return Manoeuvre(*(float(means[name]) for name in INPUTS))
