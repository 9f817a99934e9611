"""Advice on a refused tow: the speed from which the gear is towed, and changes that would calm it.

Changes of the rigging are ranked by what a small one does to the growth of the motion that grows,
or comes next to growing, and those that promise most are made larger until a state is found usable
where it was refused. Nothing is advised that was not solved.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from trawl_ros.core.errors import NoSteadyState
from trawl_ros.core.progress import OnProgress, WorkProgress, ignore
from trawl_ros.model.gear_model import GearModel
from trawl_ros.solver.advising.limit_speed import (
    closer_usable,
    nearest_usable,
    shown_speed,
    state_near,
    usable_state,
)
from trawl_ros.solver.advising.rig_changes import RigChange, rig_changes
from trawl_ros.solver.equilibrium import (
    Equilibrium,
    SteadyState,
    find_equilibrium,
    steady_state,
    with_effects,
)
from trawl_ros.solver.stability import stability

SHARES = 0.2, 0.5, 1.0
"""Parts of a change's largest amount that are tried in turn."""

PROMISING, EASING, WANTED = 5, 3, 2
"""Numbers of changes that are tried at the speed that was refused, and for a least speed; number of
remedies after which the search ends."""

GAIN = 0.02
"""Part of the least speed from which a lower one is worth telling."""


@dataclass(frozen=True)
class Remedy:
    """Change of the rigging by an amount with which a refused tow is usable.

    ``growth`` (1/s) is that of its slowest motion, negative.
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
    """Refused tow, the speeds at which the gear is towed, and remedies.

    Attributes
    ----------
    refusal
        The reason why it is refused.
    limit_speed
        Least speed (m/s) from which the gear is towed on this warp, or the highest where it breaks
        the surface; None where none was found.
    beyond
        Tow next to that speed that is refused, with the reason.
    remedies
        Changes with which it is usable at the speed that was refused.
    eased
        The change that promises most, and the speed from which the gear is towed with it; None
        where there are remedies, or none lowers it.

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
            told.append(f'on this warp it is towed {edge} {self.limit_speed:.2f} m/s')
            told += [self.beyond] * (self.beyond != told[0])
        told += [
            f'{remedy.what}: usable, the slowest motion settles in {-1.0 / remedy.growth:.0f} s'
            for remedy in self.remedies
        ]
        if self.eased is not None:
            told.append(
                'no single change of the rigging that was tried makes it usable; with '
                f'{self.eased[0]} it is towed from {self.eased[1]:.2f} m/s'
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
        Of the tow, m and m/s.
    on_progress
        Called with each change that is compared or tried.

    Returns
    -------
    Advice or None
        None where the tow is usable as it is.

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
    edge = nearest_usable(model, warp_length, speed, refusal, root)
    limit, beyond = (None, '') if edge is None else (shown_speed(edge[0], speed), edge[1])
    reference = root or (edge[0].equilibrium if edge is not None else None)
    if reference is None or refusal.reason == 'surfaced':
        return Advice(refusal, limit, beyond, ())
    ranked = _ranked(model, warp_length, reference, on_progress)
    remedies = []
    for done, (change, sign, _) in enumerate(ranked[:PROMISING]):
        on_progress(WorkProgress('changes', done, PROMISING, change.kind))
        if remedy := _tried(model, (warp_length, speed), change, sign, reference):
            remedies.append(remedy)
        if len(remedies) == WANTED:
            break
    eased = None
    if edge is not None and not remedies:
        eased = _eased(model, (warp_length, speed), ranked[:EASING], edge[0])
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
    """The change with which the gear is towed from the least speed, and that speed (m/s)."""
    best, enough = None, (1.0 - GAIN) * edge.equilibrium.point.speed
    for change, sign, _ in ranked:
        start, speed = edge.equilibrium, edge.equilibrium.point.speed
        for amount, changed, length in _amounts(model, place[0], change, sign):
            steady = usable_state(changed, length, speed, start)
            if not isinstance(steady, SteadyState):
                break
            least, _ = closer_usable(changed, length, steady, place[1], '')
            start, speed = least.equilibrium, least.equilibrium.point.speed
            if speed < enough:
                best, enough = (change.told(amount), shown_speed(least, place[1])), speed
    return best


def _ranked(
    model: GearModel, warp_length: float, reference: Equilibrium, on_progress: OnProgress
) -> list[tuple[RigChange, float, float]]:
    """Changes with the sign that calms and what a small step takes off the growth (1/s), that of
    the largest amount first.
    """
    before = stability(model, reference.state, reference.tow).growth
    changes = rig_changes(model.gear)
    found = []
    for done, change in enumerate(changes):
        on_progress(WorkProgress('compared changes', done, len(changes), change.kind))
        changed, length = change.applied(model, warp_length, change.step)
        try:
            here = state_near(changed, length, reference.point.speed, reference)
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
    """The smallest of some amounts of a change with which the tow is usable."""
    for amount, changed, length in _amounts(model, place[0], change, sign):
        try:
            there = state_near(changed, length, reference.point.speed, reference)
            reference = there
        except NoSteadyState:
            return None
        steady = usable_state(changed, length, place[1], there)
        if isinstance(steady, SteadyState):
            return Remedy(change, amount, steady.stability.growth)
    return None


def _amounts(
    model: GearModel, warp_length: float, change: RigChange, sign: float
) -> Iterator[tuple[float, GearModel, float]]:
    for share in SHARES:
        amount = sign * share * change.most
        yield (amount, *change.applied(model, warp_length, amount))
