# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Published hauls as records: sources, points and tunable values, from ``config/hauls``."""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from trawl_ros.core.errors import TrawlError
from trawl_ros.core.resources import share_path
from trawl_ros.core.schema import FrozenDict, Numbers, Record, load_yaml, validated
from trawl_ros.gear.drag_bands import KNOT
from trawl_ros.gear.net_plan import NetPlanRecord, PieceRecord
from trawl_ros.gear.records import GearRecord


class ThinnerRecord(Record):
    """Share of the net's twine area that is removed from its small meshes, by thinner twine."""

    mesh_up_to_mm: Annotated[float, Field(gt=0)]
    area_off: Annotated[float, Field(gt=0, lt=1)]


def thinner(plan: NetPlanRecord, change: ThinnerRecord) -> NetPlanRecord:
    """Return the plan with thinner twine in all pieces with meshes up to a size.

    Raises
    ------
    TrawlError
        If these pieces have less twine than is to be taken off.
    """
    quick = [piece for piece in plan.pieces if piece.mesh_mm <= change.mesh_up_to_mm]
    share = sum(piece.twine_area for piece in quick) / sum(
        piece.twine_area for piece in plan.pieces
    )
    if share <= change.area_off:
        raise TrawlError(
            f'thinner.area_off: found {change.area_off:g}, expected less than {share:.3g}, the '
            f'share of the twine area in meshes up to {change.mesh_up_to_mm:g} mm'
        )
    factor = 1.0 - change.area_off / share
    pieces = tuple(_thinned(piece, factor) if piece in quick else piece for piece in plan.pieces)
    return plan.model_copy(update={'pieces': pieces})


def _thinned(piece: PieceRecord, factor: float) -> PieceRecord:
    """Return a piece with another twine diameter; its mass per length scales with the square."""
    changed = {}
    if piece.rtex is not None:
        changed['rtex'] = factor**2 * piece.rtex
    if piece.twine_diameter_mm is not None:
        changed['twine_diameter_mm'] = factor * piece.twine_diameter_mm
    return piece.model_copy(update=changed)


FILE = ('config', 'hauls', 'published.yaml')

Quantity = Literal[
    'door_depth',
    'door_spread',
    'net_depth',
    'vertical_opening',
    'horizontal_opening',
    'warp_tension',
    'net_drag',
    'mouth_area',
    'lower_bridle_tension',
    'board_attack',
]
"""Name of a measured quantity among the `Observables` or `DERIVED`.

Units are m, m² for the area of the mouth, N for the tension of one warp or bridle and the drag of
the net, and degrees for the attack angle of the boards.
"""

Use = Literal['counts', 'tunes', 'told']
"""Use of a haul: it counts, it set one number of the gear, or it is only shown."""


class HaulSource(Record):
    """Source of hauls: title and address."""

    title: str
    address: str


class PointRecord(Record):
    """Point: a measured quantity of a haul, with its range if one is printed."""

    quantity: Quantity
    value: Annotated[float, Field(gt=0)]
    low: float | None = None
    high: float | None = None
    source: str | None = None


class HaulRecord(Record):
    """Published haul.

    ``warp_m`` is the length of each warp, and ``speed_kn`` the speed through the water.
    ``hung_weight_in_water_n`` gives weights that were changed, ``thinner`` the twine that was
    thinner than the net plan says.
    """

    name: str
    use: Use
    why: str = ''
    warp_m: Annotated[float, Field(gt=0)]
    speed_kn: Annotated[float, Field(gt=0)]
    hung_weight_in_water_n: Numbers = FrozenDict()
    thinner: ThinnerRecord | None = None
    points: tuple[PointRecord, ...]

    @property
    def speed(self) -> float:
        """Speed through the water, m/s."""
        return self.speed_kn * KNOT

    def rigged(self, gear: GearRecord) -> GearRecord:
        """Gear as it was rigged in this haul.

        Raises
        ------
        TrawlError
            If it has no weight of a name that the haul gives, or no net plan to be thinner, or
            too little twine.
        """
        gear = self._with_net(gear)
        weights = self.hung_weight_in_water_n
        missing = set(weights) - {item.name for item in gear.hung}
        if missing:
            raise TrawlError(
                f'{"/".join(FILE)}: haul {self.name} of {gear.name}: hung_weight_in_water_n: found '
                f'{", ".join(sorted(missing))}, expected names of what is hung in the gear file'
            )
        hung = tuple(
            item.model_copy(
                update={'weight_in_water_n': weights.get(item.name, item.weight_in_water_n)}
            )
            for item in gear.hung
        )
        return gear.model_copy(update={'hung': hung})

    def _with_net(self, gear: GearRecord) -> GearRecord:
        if self.thinner is None:
            return gear
        where = f'{"/".join(FILE)}: haul {self.name} of {gear.name}'
        plan = gear.netting.plan
        if plan is None:
            raise TrawlError(f'{where}: thinner: found a net without a plan, expected one')
        try:
            plan = thinner(plan, self.thinner)
        except TrawlError as reason:
            raise TrawlError(f'{where}: {reason}') from reason
        return gear.changed('netting', plan=plan)


class GearHauls(Record):
    """Hauls of one gear, with the tuned and the assumed values."""

    gear: str
    source: str
    plan: Literal['published', 'assumed']
    tuned: str
    assumed: str
    hauls: Annotated[tuple[HaulRecord, ...], Field(min_length=1)]

    @model_validator(mode='after')
    def _told(self) -> 'GearHauls':
        names = [haul.name for haul in self.hauls]
        if len(set(names)) < len(names):
            raise ValueError(f'hauls: found the names {", ".join(names)}, expected each once')
        for haul in self.hauls:
            if haul.use == 'told' and not haul.why:
                raise ValueError(f'haul {haul.name}: why: missing, expected why it does not count')
            if haul.use == 'tunes' and self.tuned == 'nothing':
                raise ValueError(f'haul {haul.name}: use: found tunes, where nothing is tuned')
        return self


class TrendRecord(Record):
    """Trend: change of a quantity from the first haul to the second, as sources print it.

    Exactly one of these is given; signs and bounds count, ratios and slopes are shown only.

    Attributes
    ----------
    sign
        Sign of the change.
    within
        Bound on the change, of either sign, in the unit of the quantity.
    ratio
        Second value over the first.
    slope
        Change of the quantity per unit of ``per``.
    """

    gear: str
    by: str
    quantity: Quantity
    first: str
    second: str
    sign: Literal[-1, 1] | None = None
    within: Annotated[float, Field(gt=0)] | None = None
    ratio: Annotated[float, Field(gt=0)] | None = None
    slope: float | None = None
    per: Literal['warp_m', 'speed_kn'] | None = None
    source: str

    @property
    def counts(self) -> bool:
        """True for a sign or a bound, which is right or wrong."""
        return self.sign is not None or self.within is not None

    @model_validator(mode='after')
    def _one_kind(self) -> 'TrendRecord':
        kinds = ('sign', 'within', 'ratio', 'slope')
        found = [kind for kind in kinds if getattr(self, kind) is not None]
        if len(found) != 1:
            raise ValueError(
                f'found {", ".join(found) or "none"}, expected one of {", ".join(kinds)}'
            )
        if (self.slope is None) != (self.per is None):
            raise ValueError('per: expected with a slope, and with nothing else')
        return self


class ReferenceRecord(Record):
    """Accuracy reached by others at sea: largest errors of depth and of drag, %."""

    depth_percent: Annotated[float, Field(gt=0)]
    drag_percent: Annotated[float, Field(gt=0)]
    source: str


class UnusedSource(Record):
    """Source that was examined and not used, with the reason."""

    source: str
    why: str


class PublishedHauls(Record):
    """All published hauls.

    They have sources by name, hauls by gear, trends, sources not used, and the accuracy to compare
    with.
    """

    sources: dict[str, HaulSource]
    reference: ReferenceRecord
    gears: Annotated[tuple[GearHauls, ...], Field(min_length=1)]
    trends: tuple[TrendRecord, ...]
    not_used: tuple[UnusedSource, ...]

    @model_validator(mode='after')
    def _named(self) -> 'PublishedHauls':
        hauls = {(gear.gear, haul.name): haul for gear in self.gears for haul in gear.hauls}
        for trend in self.trends:
            for name in (trend.first, trend.second):
                if (trend.gear, name) not in hauls:
                    raise ValueError(
                        f'trends: found haul {name} of {trend.gear}, expected one of its hauls'
                    )
            ends = [hauls[trend.gear, name] for name in (trend.first, trend.second)]
            if trend.per is not None and len({getattr(haul, trend.per) for haul in ends}) == 1:
                raise ValueError(
                    f'trends: found the same {trend.per} in {trend.first} and {trend.second} of '
                    f'{trend.gear}, expected two values for a slope'
                )
        named = {trend.source for trend in self.trends} | {gear.source for gear in self.gears}
        named.add(self.reference.source)
        for gear in self.gears:
            named |= {p.source for haul in gear.hauls for p in haul.points if p.source}
        if named - set(self.sources):
            raise ValueError(
                f'sources: found none named {", ".join(sorted(named - set(self.sources)))}'
            )
        return self


def published_hauls() -> PublishedHauls:
    """Read the hauls that come with the package.

    Raises
    ------
    TrawlError
        Naming file, key, what was found and what was expected.
    """
    path = share_path(*FILE)
    return validated(PublishedHauls, load_yaml(path, TrawlError), path, TrawlError)
