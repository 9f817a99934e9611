# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Records of ropes and rigging: warps, bridles, sweeps, frame ropes, and bodies on ropes."""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from trawl_ros.core.schema import Record
from trawl_ros.gear.numbers import Damping, Drag, Length, NotNegative, Share, Stiffness, Weight

ENDS: tuple[Literal['upper'], Literal['lower']] = 'upper', 'lower'
"""Wing tips, and fastening points of a board, that have a bridle in every gear."""

Name = Annotated[str, Field(pattern=r'^[a-z][a-z0-9_]{0,30}$')]


class RopeRecord(Record):
    """Properties of a rope; ``segments`` of its kinds is the number of its numerical bars."""

    diameter_m: Annotated[float, Field(gt=0, le=0.5)]
    """Diameter."""
    weight_in_water_n_m: Weight
    """Weight in water per metre, negative for ropes that float."""
    stiffness_n: Stiffness
    """Stiffness EA."""
    damping_time_s: Damping
    """Inner damping c_l of eq. 21, as c_l times length over EA."""
    normal_drag: Drag
    """Drag coefficient across, on the diameter."""
    tangential_drag: Drag
    """Friction coefficient along, on the surface π d."""
    added_mass_normal: Drag
    """Added mass across, over that of the displaced water."""
    added_mass_tangential: Drag
    """Added mass along, over that of the displaced water."""


class WarpRecord(RopeRecord):
    """Warp; its length is commanded to the winch."""

    segments: Annotated[int, Field(ge=2, le=500)]
    """Numerical bars of each warp."""


class BridleRecord(RopeRecord):
    """Bridle from a board to a wing tip."""

    length_m: Length
    """Length of a bridle."""
    segments: Annotated[int, Field(ge=2, le=200)]
    """Numerical bars of each bridle."""


class FrameRopeRecord(RopeRecord):
    """Rope of the frame, from wing tip to wing tip."""

    length_m: Length | None = None
    """Length of headrope, footrope or side rope; needed without a net plan, whose hanging ratios
    give it otherwise.
    """


class OwnMake(Record):
    """Properties in which a rope differs from the record ``bridle``."""

    diameter_m: Annotated[float, Field(gt=0, le=0.5)] | None = None
    """Diameter."""
    weight_in_water_n_m: Weight | None = None
    """Weight in water per metre."""
    stiffness_n: Stiffness | None = None
    """Stiffness EA."""
    segments: Annotated[int, Field(ge=2, le=200)] | None = None
    """Numerical bars."""


class SweepRecord(OwnMake):
    """Rope on either side between backstrops and bridles.

    Two backstrops lead to its front end; all bridles begin at its back end. All three have the
    properties of ``bridle`` except those given here.
    """

    length_m: Length
    """Length between backstrops and bridles."""
    upper_backstrop_m: Length
    """Length from the board's upper bridle point to the front end of the sweep."""
    lower_backstrop_m: Length
    """The same from the lower bridle point."""

    @property
    def changes(self) -> dict[str, float]:
        """Values in which it differs from ``bridle``."""
        lengths = {'upper_backstrop_m', 'lower_backstrop_m'}
        return {k: v for k, v in self.model_dump(exclude=lengths).items() if v is not None}


class OwnBridleRecord(OwnMake):
    """Bridle on either side, from a point of the board to a place of the net.

    It has the properties of ``bridle`` except those given here.
    """

    name: Name
    """Name; `hung` refers to it, as in `lower_bridle`."""
    at_board: Literal['upper', 'lower'] | None = None
    """Bridle point of the board; none behind a `sweep`."""
    at_net: Literal['upper', 'side', 'lower']
    """Wing tip, or `side` for the middle of the side rope."""
    length_m: Length | None = None
    """Length, where it is not that of `bridle`."""

    @property
    def changes(self) -> dict[str, float]:
        """Values in which it differs from ``bridle``."""
        places = {'name', 'at_board', 'at_net'}
        return {k: v for k, v in self.model_dump(exclude=places).items() if v is not None}


class HungRecord(Record):
    """Weights, chain, floats or kites on a rope, spread evenly from one share of it to another.

    Shares of a bridle or sweep count from the board to the net, those of headrope and footrope from
    port to starboard, those of side ropes from the top down. Bodies on a bridle, a sweep or a side
    rope are on either side; on headrope and footrope the numbers are those of the whole rope.
    Numbers in N/m are per metre of the rope between both shares, as for a chain. Kites have
    ``lift_area_m2``, C_L times their area, negative for depressors; they need no weight or
    buoyancy.
    """

    name: str
    """Name in messages."""
    rope: Name
    """`headrope`, `footrope`, `side_rope`, `sweep`, or a bridle as `lower_bridle`."""
    from_share: Share = 0.0
    """Part of the rope ahead of its beginning: 0 is at the board, at port or above."""
    to_share: Share = 1.0
    """The same of its end; it is spread evenly between both."""
    weight_in_water_n: NotNegative = 0.0
    """Weight in water, in all."""
    buoyancy_n: NotNegative = 0.0
    """Buoyancy, in all, less the weight of the floats."""
    weight_in_water_n_m: NotNegative = 0.0
    """Weight in water per metre of rope."""
    buoyancy_n_m: NotNegative = 0.0
    """Buoyancy per metre of rope."""
    density_kg_m3: Annotated[float, Field(gt=0, le=20_000)] | None = None
    """Density; default 7800 of weights, 300 of floats."""
    drag_area_m2: NotNegative = 0.0
    """Drag coefficient times area."""
    lift_area_m2: Annotated[float, Field(ge=-1000, le=1000)] = 0.0
    """Lift coefficient times area of kites and panels, across the flow, negative downward."""

    @model_validator(mode='after')
    def _sinks_or_floats(self) -> 'HungRecord':
        given = [
            self.weight_in_water_n,
            self.buoyancy_n,
            self.weight_in_water_n_m,
            self.buoyancy_n_m,
        ]
        found = sum(force > 0 for force in given)
        if found != 1 and not (found == 0 and self.lift_area_m2):
            raise ValueError(
                f'found {found} weights or buoyancies, expected one of weight_in_water_n, '
                'buoyancy_n, weight_in_water_n_m and buoyancy_n_m, or lift_area_m2'
            )
        if self.to_share < self.from_share:
            raise ValueError(
                f'to_share: found {self.to_share:g}, expected at least from_share, '
                f'{self.from_share:g}'
            )
        low, high = (1100.0, 20_000.0) if self.sinks else (1.0, 950.0)
        if not low <= self.density <= high:
            raise ValueError(
                f'density_kg_m3: found {self.density:g}, expected {low:g} to {high:g} for '
                f'{"weights" if self.sinks else "floats"}'
            )
        return self

    @property
    def density(self) -> float:
        """Density, kg/m³; by default that of steel, or of a float."""
        if self.density_kg_m3 is not None:
            return self.density_kg_m3
        return 7800.0 if self.sinks else 300.0

    @property
    def sinks(self) -> bool:
        """True for weights, False for floats."""
        return self.weight_in_water_n + self.weight_in_water_n_m > 0.0

    def force_on(self, length: float) -> float:
        """Return the weight in water (N), negative for floats, on a rope of this length (m)."""
        per_metre = self.weight_in_water_n_m - self.buoyancy_n_m
        spread = length * (self.to_share - self.from_share)
        return self.weight_in_water_n - self.buoyancy_n + per_metre * spread
