"""Records of the rigging between boards and net: bridles of any make, and what hangs on ropes."""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from trawl_ros.core.schema import Record
from trawl_ros.gear.numbers import Length, NotNegative, Share, Stiffness, Weight

ENDS: tuple[Literal['upper'], Literal['lower']] = 'upper', 'lower'
"""Wing tips, and points of a board, that have a bridle in any gear."""

Name = Annotated[str, Field(pattern=r'^[a-z][a-z0-9_]{0,30}$')]


class OwnMake(Record):
    """Changes of a rope from the make of the bridles."""

    diameter_m: Annotated[float, Field(gt=0, le=0.5)] | None = None
    weight_in_water_n_m: Weight | None = None
    stiffness_n: Stiffness | None = None
    segments: Annotated[int, Field(ge=2, le=200)] | None = None


class SweepRecord(OwnMake):
    """A rope on either side between backstrops and bridles.

    Two backstrops of these lengths go from the board's upper and lower bridle point to its front
    end; all bridles begin at its back end. All three are made as ``bridle`` says, but for what is
    given here.
    """

    length_m: Length
    upper_backstrop_m: Length
    lower_backstrop_m: Length

    @property
    def changes(self) -> dict[str, float]:
        """Values that are given here of the make of the bridle."""
        lengths = {'upper_backstrop_m', 'lower_backstrop_m'}
        return {k: v for k, v in self.model_dump(exclude=lengths).items() if v is not None}


class OwnBridleRecord(OwnMake):
    """A bridle on either side: from which of the board's points to which place of the net.

    It is made as ``bridle`` says, but for what is given here. ``side`` is the middle of the rope
    between upper and lower wing tip. Behind a sweep none has a place at the board.
    """

    name: Name
    at_board: Literal['upper', 'lower'] | None = None
    at_net: Literal['upper', 'side', 'lower']
    length_m: Length | None = None

    @property
    def changes(self) -> dict[str, float]:
        """Values that are given here of the make of the bridle."""
        places = {'name', 'at_board', 'at_net'}
        return {k: v for k, v in self.model_dump(exclude=places).items() if v is not None}


class HungRecord(Record):
    """Weights, chain, floats or kites on a rope, spread evenly from one share of it to another.

    Shares of a bridle or sweep count from the board to the net, those of headrope, footrope and
    side ropes from port to starboard or from the top down. What hangs on a bridle, a sweep or a
    side rope hangs there on either side; on headrope and footrope the figures are those of the
    whole rope.
    Figures in N/m are those of each metre of rope over which it is spread, as of a chain. Kites
    have ``lift_area_m2``, C_L times their area, negative where they dive; their weight or buoyancy
    may be left out.
    """

    name: str
    rope: Name
    from_share: Share = 0.0
    to_share: Share = 1.0
    weight_in_water_n: NotNegative = 0.0
    buoyancy_n: NotNegative = 0.0
    weight_in_water_n_m: NotNegative = 0.0
    buoyancy_n_m: NotNegative = 0.0
    density_kg_m3: Annotated[float, Field(gt=0, le=20_000)] | None = None
    drag_area_m2: NotNegative = 0.0
    lift_area_m2: Annotated[float, Field(ge=-1000, le=1000)] = 0.0

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
                'needs either weight_in_water_n or buoyancy_n, or one of them per metre (_n_m), '
                f'or lift_area_m2, found {found} of them'
            )
        if self.to_share < self.from_share:
            raise ValueError(
                f'to_share: found {self.to_share:g}, expected from_share, {self.from_share:g}, or '
                'more'
            )
        low, high = (1100.0, 20_000.0) if self.sinks else (1.0, 950.0)
        if not low <= self.density <= high:
            raise ValueError(
                f'density_kg_m3: found {self.density:g}, expected {low:g} to {high:g} for what '
                f'{"sinks" if self.sinks else "floats"}'
            )
        return self

    @property
    def density(self) -> float:
        """Density, kg/m³: that of steel, or of a float, where none is given."""
        if self.density_kg_m3 is not None:
            return self.density_kg_m3
        return 7800.0 if self.sinks else 300.0

    @property
    def sinks(self) -> bool:
        """True for weights, False for floats."""
        return self.weight_in_water_n + self.weight_in_water_n_m > 0.0

    def force_on(self, length: float) -> float:
        """Weight in water (N), negative for floats, on a rope of this length (m)."""
        per_metre = self.weight_in_water_n_m - self.buoyancy_n_m
        spread = length * (self.to_share - self.from_share)
        return self.weight_in_water_n - self.buoyancy_n + per_metre * spread
