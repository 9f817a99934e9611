# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Steady states of the tank's net on its floor."""

from dataclasses import dataclass, replace

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import NoSteadyState
from trawl_ros.gear.records import GearRecord
from trawl_ros.lab.validation.tank.states import BRIDLE, SHACKLE, SWEEP, TRUNCATED, FlumeState
from trawl_ros.model.assembly import bar_tensions
from trawl_ros.model.gear_model import GearModel, build_model
from trawl_ros.model.net.wake import KINEMATIC_VISCOSITY_M2_S
from trawl_ros.solver.equilibrium import Equilibrium, find_equilibrium
from trawl_ros.solver.operating_point import OperatingPoint

STUB_LENGTH_M = 0.5
"""Length (m) of the rope without weight and drag between a mast and the net's ropes."""

HEIGHT_TOLERANCE_M = 0.002
"""Height (m) over the floor at which the footrope lies on it."""

FIRST_SHARE, STEP_SHARE, MOST = 0.2, 0.02, 30
"""Shares of the footrope's weight that the search tries first; and how often it tries."""

MODEL_SCALE = 8
"""Scale of the tank's net: readings are multiples of 0.08 m, a centimetre in the tank.

Speeds scale with its square root, so Reynolds numbers with its power of 3/2.
"""

TANK_VISCOSITY = 1.05e-6
"""Kinematic viscosity of the tank's water, taken as at 20 °C, m²/s."""

LEADING_STEPS = 4
"""Number of steps from one state to another."""


@dataclass(frozen=True)
class HeldNet:
    """Net held by its pulling points.

    Attributes
    ----------
    model, found
        Model and its equilibrium.
    elevation
        Height of the frame's origin above the floor, m.
    floor
        Weight of the footrope that the floor carries, N.
    """

    model: GearModel
    found: Equilibrium
    elevation: float
    floor: float

    @property
    def spread(self) -> float:
        """Distance (m) between the upper wing tips."""
        return self.found.observables.horizontal_opening

    @property
    def height(self) -> float:
        """Height (m) of the headrope's middle above that of the footrope."""
        return self.found.observables.vertical_opening

    @property
    def tension(self) -> float:
        """Tension (N) at both pulling points together."""
        seen = self.found.observables
        return seen.port_tension + seen.starboard_tension

    @property
    def laid(self) -> float:
        """Weight in water (N) of the lower bridles, which the floor carries.

        They are made as the upper ones.
        """
        return 2.0 * (BRIDLE + SHACKLE) * self.model.gear.bridle.weight_in_water_n_m

    @property
    def lower_spread(self) -> float:
        """Distance (m) between the lower wing tips."""
        ends = self._nodes[self.model.layout.footrope[[0, -1]]]
        return float(np.linalg.norm(ends[1] - ends[0]))

    @property
    def wing_height(self) -> float:
        """Height (m) of the upper wing tips above the floor."""
        return float(self._nodes[self.model.layout.headrope[0], 2]) + self.elevation

    @property
    def lower_share(self) -> float:
        """Share of the lower bridles in the tension of all bridles."""
        pulls = bar_tensions(self.model, self.found.state, self.found.tow)
        upper, lower = (
            float(np.mean(pulls[own]))
            for name, _, own in self.model.layout.lines
            if name in ('port_upper_bridle', 'port_lower_bridle')
        )
        return lower / (upper + lower)

    @property
    def _nodes(self) -> FloatArray:
        return np.real(self.found.state.nodes)


def in_the_tank(model: GearModel) -> GearModel:
    """Return a gear whose netting has the drag of the tank's small twine and slow water."""
    factor = np.sqrt(TANK_VISCOSITY * MODEL_SCALE**1.5 / KINEMATIC_VISCOSITY_M2_S)
    bars = model.bars
    return replace(
        model,
        bars=replace(
            bars,
            normal_viscous=factor * bars.normal_viscous,
            friction_viscous=factor * bars.friction_viscous,
        ),
        lump_viscous_area=factor * model.lump_viscous_area,
    )


def held(
    gear: GearRecord,
    state: FlumeState,
    near: HeldNet | None = None,
    *,
    tank_twine: bool = True,
) -> HeldNet:
    """Find the net of a state, with its footrope on the floor.

    The floor carries sweeps and lower bridles, and of the footrope as much as lets its middle lie
    where the floor is: what is left on the net is sought, spread evenly. There is no friction.
    Its twine is that of the tank where ``tank_twine`` is true, else as large as at sea. The search
    begins at ``near``, or cold.

    Raises
    ------
    NoSteadyState
        If the net comes to rest nowhere on the way.
    """
    whole = gear.footrope.weight_in_water_n_m * (gear.footrope.length_m or 0.0)
    length = SWEEP if state.sweeps else STUB_LENGTH_M
    point = OperatingPoint(length, length, state.speed)

    def below(share: float, start: Equilibrium | None) -> tuple[float, GearModel, Equilibrium]:
        model = build_model(_rigged(gear, state, share))
        model = in_the_tank(model) if tank_twine else model
        found = find_equilibrium(model, point, start)
        seen = found.observables
        return seen.net_depth + seen.vertical_opening - state.elevation, model, found

    share = FIRST_SHARE if near is None else 1.0 - near.floor / whole
    deep, model, found = below(share, None if near is None else near.found)
    slope = None
    for _ in range(MOST):
        if abs(deep) <= HEIGHT_TOLERANCE_M:
            return HeldNet(model, found, state.elevation, (1.0 - share) * whole)
        step = STEP_SHARE if slope is None else -deep / slope
        step = max(-0.2, min(0.2, step))
        deeper, model, found = below(share + step, found)
        slope = (deeper - deep) / step
        share, deep = share + step, deeper
    raise NoSteadyState(
        f'trial {state.trial}: the footrope was left {deep:+.3f} m below the floor, expected it '
        'there'
    )


def led_to(gear: GearRecord, state: FlumeState, known: FlumeState, net: HeldNet) -> HeldNet:
    """Move the net of a known state to another state of the same rig, in equal steps.

    Raises
    ------
    NoSteadyState
        If it comes to rest no more on the way: with the trial it was led from, and how far it came.
    """
    reached = 0
    for step in range(1, LEADING_STEPS + 1):
        share = step / LEADING_STEPS
        between = replace(
            state,
            **{
                name: getattr(known, name) + share * (getattr(state, name) - getattr(known, name))
                for name in ('speed', 'pulling_points', 'elevation')
            },
        )
        try:
            net = held(gear, between, near=net)
        except NoSteadyState as reason:
            raise NoSteadyState(
                f'led from trial {known.trial} the net came {reached} of {LEADING_STEPS} steps: '
                f'{reason}'
            ) from None
        reached = step
    return net


def _rigged(gear: GearRecord, state: FlumeState, share: float) -> GearRecord:
    """Return the gear as rigged for a state, with a share of the footrope's weight."""
    assert gear.pair is not None
    foot = gear.footrope.weight_in_water_n_m * share
    length = SWEEP if state.sweeps else TRUNCATED if state.short else BRIDLE
    bridles = tuple(
        bridle.model_copy(
            update={'length_m': length + (SHACKLE if bridle.at_net == 'lower' else 0.0)}
        )
        for bridle in gear.bridles or ()
    )
    front = {'weight_in_water_n_m': 0.0}
    if not state.sweeps:
        front |= {'normal_drag': 0.0, 'tangential_drag': 0.0, 'segments': 2}
    return gear.model_copy(
        update={
            'pair': gear.pair.model_copy(update={'distance_m': state.pulling_points}),
            'warp': gear.warp.model_copy(update=front),
            'footrope': gear.footrope.model_copy(update={'weight_in_water_n_m': foot}),
            'bridles': bridles,
        }
    )
