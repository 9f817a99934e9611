# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Advice on a refused tow: the speed from which the gear can be towed, and helpful changes.

Changes of the rigging are ranked by the effect of a small one on the growth of the least stable
motion. The most promising are made larger until the refused state is usable. All advice was solved.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from trawl_ros.core.errors import NoSteadyState
from trawl_ros.core.progress import OnProgress, WorkProgress, ignore
from trawl_ros.model.gear_model import GearModel
from trawl_ros.solver.advising.rig_changes import RigChange, rig_changes
from trawl_ros.solver.equilibrium import (
    Equilibrium,
    SteadyState,
    find_equilibrium,
    require_usable,
    steady_state,
    with_effects,
)
from trawl_ros.solver.stability import stability


@dataclass(frozen=True)
class AdviceOptions:
    """Options of the search for advice.

    Attributes
    ----------
    amount_fractions
        Fractions of a change's largest amount that are tried in turn.
    tried_changes, tried_for_speed
        Numbers of changes that are tried at the refused speed, and for a lower least speed.
    remedies
        Number of remedies after which the search ends.
    min_speed_gain
        Relative reduction of the least speed that is reported.
    faster, slower
        Multiples of a refused speed at which a usable state is sought; slower ones if the gear
        breaks the surface.
    speed_tolerance
        Relative tolerance of the least or highest usable speed.
    """

    amount_fractions: tuple[float, ...] = (0.2, 0.5, 1.0)
    tried_changes: int = 5
    tried_for_speed: int = 3
    remedies: int = 2
    min_speed_gain: float = 0.02
    faster: tuple[float, ...] = (1.1, 1.3, 1.7)
    slower: tuple[float, ...] = (0.9, 0.75, 0.6)
    speed_tolerance: float = 0.01


OPTIONS = AdviceOptions()


@dataclass(frozen=True)
class Remedy:
    """Change of the rigging by an amount with which a refused tow is usable.

    ``growth`` (1/s) is that of its slowest motion and negative.
    """

    change: RigChange
    amount: float
    growth: float

    @property
    def what(self) -> str:
        """The change in words."""
        return self.change.told(self.amount)


@dataclass(frozen=True)
class Advice:
    """Refused tow, speeds at which the gear can be towed, and remedies.

    Attributes
    ----------
    refusal
        Reason of the refusal.
    limit_speed
        Least speed (m/s) at which the gear can be towed on this warp, or the highest if it breaks
        the surface; None if none was found.
    beyond
        Refused tow next to that speed, with the reason.
    remedies
        Changes with which the tow is usable at the refused speed.
    eased
        Change that lowers the least speed most, and this speed; None if there are remedies, or if
        no change lowers it.

    Examples
    --------
    >>> import trawl_ros
    >>> model = trawl_ros.build_model(trawl_ros.load_gear('kaifuha').refined(net=0.25))
    >>> from trawl_ros.solver.advising.advice import advice
    >>> found = advice(model, warp_length=200.0, speed=3.5)
    >>> found.refusal.reason, round(found.limit_speed, 1)
    ('surfaced', 2.9)
    """

    refusal: NoSteadyState
    limit_speed: float | None
    beyond: str
    remedies: tuple[Remedy, ...]
    eased: tuple[str, float] | None = None

    @property
    def lines(self) -> tuple[str, ...]:
        """Sentences, the reason first."""
        told = [str(self.refusal)]
        if self.limit_speed is not None:
            edge = 'up to' if self.refusal.reason == 'surfaced' else 'from'
            told.append(f'on this warp the gear can be towed {edge} {self.limit_speed:.2f} m/s')
            told += [self.beyond] * (self.beyond != told[0])
        told += [
            f'{remedy.what}: usable; its slowest motion settles in {-1.0 / remedy.growth:.0f} s'
            for remedy in self.remedies
        ]
        if self.eased is not None:
            told.append(
                'none of the changes tried makes this tow usable; with '
                f'{self.eased[0]} the gear can be towed from {self.eased[1]:.2f} m/s'
            )
        return tuple(told)


def advice(
    model: GearModel, warp_length: float, speed: float, on_progress: OnProgress = ignore
) -> Advice | None:
    """Find what would make a refused tow usable.

    Parameters
    ----------
    model
        From `build_model`; effects of its gear file act.
    warp_length, speed
        Values of the tow, m and m/s.
    on_progress
        Called with each change that is compared or tried.

    Returns
    -------
    Advice or None
        None if the tow is usable as it is.

    Examples
    --------
    >>> import trawl_ros
    >>> model = trawl_ros.build_model(trawl_ros.load_gear('kaifuha').refined(net=0.25))
    >>> from trawl_ros.solver.advising.advice import advice
    >>> print(advice(model, warp_length=500.0, speed=2.1))
    None
    """
    try:
        steady_state(model, warp_length, speed)
    except NoSteadyState as reason:
        refusal = reason
    else:
        return None
    root = _root(model, warp_length, speed) if refusal.reason == 'unstable' else None
    edge = _nearest_usable(model, warp_length, speed, refusal, root)
    limit, beyond = (None, '') if edge is None else (_shown_speed(edge[0], speed), edge[1])
    reference = root or (edge[0].equilibrium if edge is not None else None)
    if reference is None or refusal.reason == 'surfaced':
        return Advice(refusal, limit, beyond, ())
    ranked = _ranked(model, warp_length, reference, on_progress)
    remedies = []
    for done, (change, sign, _) in enumerate(ranked[: OPTIONS.tried_changes]):
        on_progress(WorkProgress('changes', done, OPTIONS.tried_changes, change.kind))
        if remedy := _tried(model, (warp_length, speed), change, sign, reference):
            remedies.append(remedy)
        if len(remedies) == OPTIONS.remedies:
            break
    eased = None
    if edge is not None and not remedies:
        eased = _eased(model, (warp_length, speed), ranked[: OPTIONS.tried_for_speed], edge[0])
    return Advice(refusal, limit, beyond, tuple(remedies), eased)


def _root(model: GearModel, warp_length: float, speed: float) -> Equilibrium | None:
    acting, point = with_effects(model, (warp_length, warp_length), speed)
    try:
        return find_equilibrium(acting, point)
    except NoSteadyState:
        return None


def _eased(
    model: GearModel,
    place: tuple[float, float],
    ranked: list[tuple[RigChange, float, float]],
    edge: SteadyState,
) -> tuple[str, float] | None:
    """Find the change that lowers the least speed most, and that speed (m/s)."""
    best, enough = None, (1.0 - OPTIONS.min_speed_gain) * edge.equilibrium.point.speed
    for change, sign, _ in ranked:
        start, speed = edge.equilibrium, edge.equilibrium.point.speed
        for amount, changed, length in _amounts(model, place[0], change, sign):
            steady = _usable_state(changed, length, speed, start)
            if not isinstance(steady, SteadyState):
                break
            least, _ = _closer_usable(changed, length, steady, place[1], '')
            start, speed = least.equilibrium, least.equilibrium.point.speed
            if speed < enough:
                best, enough = (change.told(amount), _shown_speed(least, place[1])), speed
    return best


def _ranked(
    model: GearModel, warp_length: float, reference: Equilibrium, on_progress: OnProgress
) -> list[tuple[RigChange, float, float]]:
    """Rank changes by their effect on the growth (1/s), extrapolated to the largest amount.

    Each comes with the sign that stabilises and the effect of a small step.
    """
    before = stability(model, reference.state, reference.tow).growth
    changes = rig_changes(model.gear)
    found = []
    for done, change in enumerate(changes):
        on_progress(WorkProgress('compared changes', done, len(changes), change.kind))
        changed, length = change.applied(model, warp_length, change.step)
        try:
            here = _state_near(changed, length, reference.point.speed, reference)
        except NoSteadyState:
            continue
        more = stability(changed, here.state, here.tow).growth - before
        found.append((change, -float(np.sign(more)), abs(more)))
    found.sort(key=lambda one: -one[2] * one[0].most / one[0].step)
    return found


def _tried(
    model: GearModel,
    place: tuple[float, float],
    change: RigChange,
    sign: float,
    reference: Equilibrium,
) -> Remedy | None:
    """Find the smallest tried amount of a change with which the tow is usable."""
    for amount, changed, length in _amounts(model, place[0], change, sign):
        try:
            there = _state_near(changed, length, reference.point.speed, reference)
            reference = there
        except NoSteadyState:
            return None
        steady = _usable_state(changed, length, place[1], there)
        if isinstance(steady, SteadyState):
            return Remedy(change, amount, steady.stability.growth)
    return None


def _amounts(
    model: GearModel, warp_length: float, change: RigChange, sign: float
) -> Iterator[tuple[float, GearModel, float]]:
    for share in OPTIONS.amount_fractions:
        amount = sign * share * change.most
        yield (amount, *change.applied(model, warp_length, amount))


def _state_near(
    model: GearModel, warp_length: float, speed: float, start: Equilibrium
) -> Equilibrium:
    """Find the equilibrium at a warp length and speed, only from a known one."""
    acting, point = with_effects(model, (warp_length, warp_length), speed)
    return find_equilibrium(acting, point, start, cold=False)


def _usable_state(
    model: GearModel, warp_length: float, speed: float, start: Equilibrium
) -> SteadyState | NoSteadyState:
    """Find the usable state at a warp length and speed from a known one, or its refusal."""
    acting, _ = with_effects(model, (warp_length, warp_length), speed)
    try:
        return require_usable(acting, _state_near(model, warp_length, speed, start))
    except NoSteadyState as reason:
        return reason


def _nearest_usable(
    model: GearModel,
    warp_length: float,
    speed: float,
    refusal: NoSteadyState,
    root: Equilibrium | None,
) -> tuple[SteadyState, str] | None:
    """Find the usable state nearest in speed to the refused one, and the refusal next to it."""
    bad, beyond = speed, str(refusal)
    for factor in OPTIONS.slower if refusal.reason == 'surfaced' else OPTIONS.faster:
        if root is not None:
            found = _usable_state(model, warp_length, factor * speed, root)
        else:
            try:
                found = steady_state(model, warp_length, factor * speed)
            except NoSteadyState as reason:
                found = reason
        if isinstance(found, SteadyState):
            return _closer_usable(model, warp_length, found, bad, beyond)
        bad, beyond = factor * speed, str(found)
    return None


def _closer_usable(
    model: GearModel, warp_length: float, found: SteadyState, bad: float, beyond: str
) -> tuple[SteadyState, str]:
    """Bisect between a usable state and a refused speed; return the state and the refusal."""
    good = found.equilibrium.point.speed
    while abs(good - bad) > OPTIONS.speed_tolerance * bad:
        middle = round(0.5 * (good + bad), 3)
        nearer = _usable_state(model, warp_length, middle, found.equilibrium)
        if isinstance(nearer, SteadyState):
            found, good = nearer, middle
        else:
            bad, beyond = middle, str(nearer)
    return found, beyond


def _shown_speed(edge: SteadyState, speed: float) -> float:
    """Return the speed of a state rounded to cm/s, away from the refused speed."""
    own = edge.equilibrium.point.speed
    return float((np.ceil if own > speed else np.floor)(100.0 * own - 1e-6) / 100.0)
