"""Steady states of the tank's net on its floor."""

from dataclasses import dataclass

from trawl_ros.core.errors import NoSteadyState
from trawl_ros.gear.records import GearRecord
from trawl_ros.lab.studies.flume.states import FlumeState
from trawl_ros.model.gear_model import build_model
from trawl_ros.solver.equilibrium import Equilibrium, find_equilibrium
from trawl_ros.solver.operating_point import OperatingPoint

LEG, SHORTER = 18.5, 11.6
"""Length (m) of the legs from the pulling points to what follows, normal and short: the way from
pulling point to wing tip that spreads and printed angles of trials 1 and 7 leave, less 54.9 m."""

SWEEP, BEHIND_SWEEP = 27.4, 27.4

PRECISE = 0.002
"""Height (m) over the floor at which the footrope lies on it."""

FIRST_SHARE, STEP_SHARE, MOST = 0.2, 0.02, 30
"""Shares of the footrope's weight that the search tries first; and how often it tries."""


@dataclass(frozen=True)
class HeldNet:
    """Net held by its pulling points: its equilibrium, and what the floor carries of the
    footrope (N).
    """

    found: Equilibrium
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


def held(gear: GearRecord, state: FlumeState) -> HeldNet:
    """Find the net of a state, with its footrope on the floor.

    The floor carries legs and lower bridles, and of the footrope as much as lets its middle lie
    where the floor is: what is left on the net is sought, spread evenly. There is no friction.

    Raises
    ------
    NoSteadyState
        If the net comes to rest nowhere on the way.
    """
    whole = gear.footrope.weight_in_water_n_m * (gear.footrope.length_m or 0.0)
    leg = (SHORTER if state.short else LEG) + (SWEEP if state.sweeps else 0.0)
    point = OperatingPoint(leg, leg, state.speed)

    def below(share: float, start: Equilibrium | None) -> tuple[float, Equilibrium]:
        model = build_model(_rigged(gear, state, share))
        found = find_equilibrium(model, point, start)
        seen = found.observables
        return seen.net_depth + seen.vertical_opening - state.elevation, found

    share, found = FIRST_SHARE, None
    deep, found = below(share, found)
    slope = None
    for _ in range(MOST):
        if abs(deep) <= PRECISE:
            return HeldNet(found, (1.0 - share) * whole)
        step = STEP_SHARE if slope is None else -deep / slope
        step = max(-0.2, min(0.2, step))
        deeper, found = below(share + step, found)
        slope = (deeper - deep) / step
        share, deep = share + step, deeper
    raise NoSteadyState(
        f'trial {state.trial}: the footrope was left {deep:+.3f} m below the floor, expected it '
        'there'
    )


def _rigged(gear: GearRecord, state: FlumeState, share: float) -> GearRecord:
    """Gear as it stood for a state, with a share of the footrope's weight."""
    assert gear.pair is not None
    foot = gear.footrope.weight_in_water_n_m * share
    bridles = gear.bridles
    if state.sweeps:
        bridles = tuple(
            bridle.model_copy(update={'length_m': BEHIND_SWEEP}) for bridle in bridles or ()
        )
    return gear.model_copy(
        update={
            'pair': gear.pair.model_copy(update={'distance_m': state.pulling_points}),
            'warp': gear.warp.model_copy(update={'weight_in_water_n_m': 0.0}),
            'footrope': gear.footrope.model_copy(update={'weight_in_water_n_m': foot}),
            'bridles': bridles,
        }
    )
