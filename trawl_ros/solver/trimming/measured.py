"""Angles of boards from what was measured at one operating point: their spread and depth.

A board that is held at an attitude is where its lift, drag and weight and the ropes balance. Attack
decides on its spread, lean on its depth; so two readings give two angles, without a fastening
point.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import NoSteadyState
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.observables import observe
from trawl_ros.records.observables import Observables
from trawl_ros.solver.trimming.held_gear import HeldGear, attitude_at, coarsest_model

LEANS = np.radians([-35.0, 50.0])
"""Inclinations among which is sought, inward and outward."""

STARTS = (0.7, 0.5), (0.4, 0.75), (0.7, 0.2)
"""Starts of the searches, as shares of the ranges of attack and inclination."""

MET = 0.01
"""Part of a wish by which it may be missed and still counts as met."""

STEP = np.radians(0.3)
"""Change of an angle for differences; shapes are found to less than that."""


@dataclass(frozen=True)
class MeasuredAngles:
    """Angles (rad) at which held boards come nearest to a wanted spread and depth (m).

    ``observables`` are those with the boards held; ``met`` says that both wishes are.
    """

    attack: float
    inclination: float
    spread: float
    depth: float
    observables: Observables

    @property
    def met(self) -> bool:
        """True if spread and depth are those wanted within `MET`."""
        return self.missed_by < MET

    @property
    def missed_by(self) -> float:
        """Larger of the parts by which the wishes for spread and depth are missed."""
        seen = self.observables
        return max(
            abs(seen.door_spread / self.spread - 1.0), abs(seen.door_depth / self.depth - 1.0)
        )

    @property
    def missed(self) -> str:
        """Wishes that are not met, and by how much."""
        seen = self.observables
        pairs = ('spread', seen.door_spread, self.spread), ('depth', seen.door_depth, self.depth)
        return ' and '.join(
            f'the {name} by {100 * (value / wanted - 1):+.0f} %'
            for name, value, wanted in pairs
            if abs(value / wanted - 1) >= MET
        )

    def told(self, tension: float | None = None) -> str:
        """Sentence on what is met and what is nearest; ``tension`` (N) of a warp if measured."""
        seen = self.observables
        found = (
            f'spread {seen.door_spread:.1f} m, door depth {seen.door_depth:.1f} m, tension '
            f'{seen.warp_tension / 1e3:.1f} kN at α {np.degrees(self.attack):.1f}°, '
            f'δ {np.degrees(self.inclination):.1f}°'
        )
        if self.met:
            sentence = f'wanted spread and depth are met: {found}'
        else:
            sentence = (
                f'boards of this law cannot be {self.spread:.4g} m apart and {self.depth:.4g} m '
                f'deep; nearest: {found}; missed: {self.missed}'
            )
        if tension is not None:
            ratio = seen.warp_tension / tension
            sentence += f'; the tension is {ratio:.2f} times the measured {tension / 1e3:.1f} kN'
        return sentence


def angles_from(
    model: GearModel,
    *,
    spread: float,
    depth: float,
    warp_length: float,
    speed: float,
    pitch: float = 0.0,
) -> MeasuredAngles:
    """Find the angles at which held boards have a spread and depth, or come nearest to them.

    Parameters
    ----------
    model
        The gear; its points only say where the bridles begin.
    spread, depth
        Measured between the boards and of the boards, m.
    warp_length, speed
        At which they were measured, m and m/s.
    pitch
        Of the boards, nose down, rad.

    Returns
    -------
    MeasuredAngles
        Within the range of the boards' law.

    Raises
    ------
    NoSteadyState
        If the gear has no shape with its boards held.
    GearError
        For a gear without boards.
    """
    model.gear.require_boards('whose angles could be found')
    model = coarsest_model(model)
    low, high = model.board.law_range
    margin = 0.02 * (high - low)
    # A pitched board leans at least by its pitch.
    leans = LEANS if pitch == 0.0 else np.array([abs(pitch), LEANS[1]])
    bounds = np.array([[low + margin, leans[0]], [high - margin, leans[1]]])
    search = _Search(model, spread, depth, (warp_length, speed), pitch)
    for share in STARTS:
        start = bounds[0] + np.multiply(share, bounds[1] - bounds[0])
        if not search.begins(start):
            continue
        found = least_squares(
            search.missed,
            start,
            bounds=bounds,
            diff_step=STEP,
            x_scale=[0.1, 0.2],
            xtol=1e-4,
            ftol=1e-6,
            max_nfev=15,
        )
        # On a bound it is the board that cannot do more, not the search.
        if found.active_mask.any() or (search.best is not None and search.best.met):
            break
    if search.best is None:
        raise NoSteadyState(
            f'warp {warp_length:g} m at {speed:g} m/s: with its boards held at any angles the gear '
            'finds no shape'
        )
    return search.best


class _Search:
    """Shapes with held boards, one from another, and the nearest of them to what is wanted."""

    def __init__(
        self,
        model: GearModel,
        spread: float,
        depth: float,
        place: tuple[float, float],
        pitch: float,
    ) -> None:
        self.model, self.place, self.pitch = model, place, pitch
        self.wanted = np.array([spread, depth])
        self.best: MeasuredAngles | None = None
        self._least = np.inf
        self._held: HeldGear | None = None

    def begins(self, angles: FloatArray) -> bool:
        """Find a shape anew; False where there is none."""
        try:
            self._held = HeldGear(self.model, self._rotations(angles), [self.place])
        except NoSteadyState:
            return False
        return True

    def missed(self, angles: FloatArray) -> FloatArray:
        """Parts (2,) by which spread and depth are missed."""
        assert self._held is not None
        try:
            self._held.turned(self._rotations(angles), self.model.board.points)
        except NoSteadyState:
            return np.ones(2)
        (acting, tow), state = self._held.acting[0], self._held.states[0]
        seen = observe(acting, state, tow)
        missed: FloatArray = np.array([seen.door_spread, seen.door_depth]) / self.wanted - 1.0
        if (miss := float(missed @ missed)) < self._least:
            self._least = miss
            spread, depth = map(float, self.wanted)
            self.best = MeasuredAngles(float(angles[0]), float(angles[1]), spread, depth, seen)
        return missed

    def _rotations(self, angles: FloatArray) -> FloatArray:
        attack, inclination = map(float, angles)
        return attitude_at(self.model, self.place, attack, inclination, self.pitch)
