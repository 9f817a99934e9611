# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Angles of boards from the measured spread and depth at one operating point.

The position of a held board balances lift, drag, weight and ropes. Attack determines its spread
and inclination its depth, so two readings give two angles, without the fastening points.
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

INCLINATION_RANGE = np.radians([-35.0, 50.0])
"""Range of the inclinations sought, inward and outward, rad."""

STARTS = (0.7, 0.5), (0.4, 0.75), (0.7, 0.2)
"""Starts of the searches, as fractions of the ranges of attack and inclination."""

MAX_RELATIVE_MISS = 0.01
"""Largest relative difference from a wanted value that counts as met."""

ANGLE_STEP = np.radians(0.3)
"""Step of differences by an angle, rad: larger than the error of a shape."""


@dataclass(frozen=True)
class MeasuredAngles:
    """Angles (rad) at which held boards come nearest to a wanted spread and depth (m).

    ``observables`` are those with the boards held; ``met`` is True if both values are reached.
    """

    attack: float
    inclination: float
    spread: float
    depth: float
    observables: Observables

    @property
    def met(self) -> bool:
        """True if spread and depth are as wanted, within `MAX_RELATIVE_MISS`."""
        return self.missed_by < MAX_RELATIVE_MISS

    @property
    def missed_by(self) -> float:
        """Larger of the relative differences of spread and depth from those wanted."""
        seen = self.observables
        return max(
            abs(seen.door_spread / self.spread - 1.0), abs(seen.door_depth / self.depth - 1.0)
        )

    @property
    def missed(self) -> str:
        """Values that are not reached, and by how much."""
        seen = self.observables
        pairs = ('spread', seen.door_spread, self.spread), ('depth', seen.door_depth, self.depth)
        return ' and '.join(
            f'the {name} by {100 * (value / wanted - 1):+.0f} %'
            for name, value, wanted in pairs
            if abs(value / wanted - 1) >= MAX_RELATIVE_MISS
        )

    def told(self, tension: float | None = None) -> str:
        """Describe the result in a sentence; ``tension`` (N) of a warp if it was measured."""
        seen = self.observables
        found = (
            f'spread {seen.door_spread:.1f} m, door depth {seen.door_depth:.1f} m, tension '
            f'{seen.warp_tension / 1e3:.1f} kN at α {np.degrees(self.attack):.1f}°, '
            f'δ {np.degrees(self.inclination):.1f}°'
        )
        if self.met:
            sentence = f'the wanted spread and depth are reached: {found}'
        else:
            sentence = (
                f'boards with this law cannot reach a spread of {self.spread:.4g} m and a depth of '
                f'{self.depth:.4g} m; nearest: {found}; missed: {self.missed}'
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
        The gear; its points only determine where the bridles begin.
    spread, depth
        Measured distance between the boards and depth of the boards, m.
    warp_length, speed
        Operating point of the measurement, m and m/s.
    pitch
        Pitch of the boards, nose down, rad.

    Returns
    -------
    MeasuredAngles
        Angles within the range of the boards' law.

    Raises
    ------
    NoSteadyState
        If the gear has no shape with its boards held at any of the angles tried.
    GearError
        For a gear without boards.
    """
    model.gear.require_boards('whose angles could be found')
    model = coarsest_model(model)
    low, high = model.board.law.range
    margin = 0.02 * (high - low)
    # The tilt of a pitched board is at least its pitch.
    inclinations = inclination_range(pitch)
    bounds = np.array([[low + margin, inclinations[0]], [high - margin, inclinations[1]]])
    search = _Search(model, spread, depth, (warp_length, speed), pitch)
    for share in STARTS:
        start = bounds[0] + np.multiply(share, bounds[1] - bounds[0])
        if not search.begins(start):
            continue
        found = least_squares(
            search.missed,
            start,
            bounds=bounds,
            diff_step=ANGLE_STEP,
            x_scale=[0.1, 0.2],
            xtol=1e-4,
            ftol=1e-6,
            max_nfev=15,
        )
        # On a bound the board cannot do more, so another start does not help.
        if found.active_mask.any() or (search.best is not None and search.best.met):
            break
    if search.best is None:
        raise NoSteadyState(
            f'warp {warp_length:g} m at {speed:g} m/s: the gear has no shape with its boards held '
            'at any of the angles tried'
        )
    return search.best


def inclination_range(pitch: float) -> FloatArray:
    """Return the range (2,) of inclinations sought at a pitch, rad."""
    return INCLINATION_RANGE if pitch == 0.0 else np.array([abs(pitch), INCLINATION_RANGE[1]])


class _Search:
    """Shapes with held boards, each from the one before, and the nearest to the wanted values."""

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
        """Find a first shape; return False if there is none."""
        try:
            self._held = HeldGear(self.model, self._rotations(angles), [self.place])
        except NoSteadyState:
            return False
        return True

    def missed(self, angles: FloatArray) -> FloatArray:
        """Return the relative differences (2,) of spread and depth from those wanted."""
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
