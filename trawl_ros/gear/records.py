"""Records of the gear file: every key carries its unit, every value is checked on load."""

from itertools import pairwise
from typing import Annotated, Literal

from pydantic import Field, model_validator

from trawl_ros.core.schema import FrozenDict, Numbers, Record
from trawl_ros.gear.boards import CORRECTIONS, BoardRecord, StartRecord
from trawl_ros.gear.net_plan import NetPlanRecord
from trawl_ros.gear.numbers import Degrees, NotNegative, Positive
from trawl_ros.gear.rigging import HungRecord, OwnBridleRecord


class CurrentAt(Record):
    """Current at a depth, to the east and the north."""

    depth_m: NotNegative
    east_m_s: Annotated[float, Field(ge=-3, le=3)]
    north_m_s: Annotated[float, Field(ge=-3, le=3)]


class TemperatureAt(Record):
    """Temperature of the water at a depth."""

    depth_m: NotNegative
    temperature_deg_c: Annotated[float, Field(ge=-2, le=35)]


class WaterRecord(Record):
    """The sea: density rises linearly with depth; current and temperature follow the given depths.

    Temperature and salinity decide on the speed of sound, and not on the density.
    """

    density_kg_m3: Annotated[float, Field(ge=990, le=1060)]
    density_gradient_kg_m4: Annotated[float, Field(ge=0, le=0.1)] = 0.0
    gravity_m_s2: Annotated[float, Field(ge=9.7, le=9.9)] = 9.80665
    current: tuple[CurrentAt, ...] = ()
    temperature: Annotated[tuple[TemperatureAt, ...], Field(min_length=1)] = (
        TemperatureAt(depth_m=0.0, temperature_deg_c=8.0),
    )
    salinity_g_kg: Annotated[float, Field(ge=0, le=42)] = 35.0

    @model_validator(mode='after')
    def _depths_rise(self) -> 'WaterRecord':
        for key, levels in (('current', self.current), ('temperature', self.temperature)):
            depths = [level.depth_m for level in levels]
            if any(b <= a for a, b in pairwise(depths)):
                raise ValueError(f'{key}: depths must rise, found {depths}')
        return self


class ShipRecord(Record):
    """Ship: spacing of the towing blocks, and limits of acceleration and turning."""

    block_spacing_m: Annotated[float, Field(gt=0, le=50)]
    max_acceleration_m_s2: Annotated[float, Field(gt=0, le=1)]
    max_turn_acceleration_deg_s2: Annotated[float, Field(gt=0, le=5)]


class WinchRecord(Record):
    """Limits of a winch's speed and acceleration."""

    max_speed_m_s: Annotated[float, Field(gt=0, le=5)]
    max_acceleration_m_s2: Annotated[float, Field(gt=0, le=5)]


class RopeRecord(Record):
    """Rope of one make; ``segments`` is the number of numerical bars it is cut into."""

    diameter_m: Annotated[float, Field(gt=0, le=0.5)]
    weight_in_water_n_m: float
    stiffness_n: Positive
    damping_time_s: NotNegative
    normal_drag: NotNegative
    tangential_drag: NotNegative
    added_mass_normal: NotNegative
    added_mass_tangential: NotNegative


class WarpRecord(RopeRecord):
    """Warp; its length is commanded to the winch."""

    segments: Annotated[int, Field(ge=2, le=500)]


class BridleRecord(RopeRecord):
    """A bridle from a board to a wing tip."""

    length_m: Positive
    segments: Annotated[int, Field(ge=2, le=200)]


class FrameRopeRecord(RopeRecord):
    """Rope of the frame, from wing tip to wing tip.

    Without a length it is as long as the hanging ratios of the net plan make it.
    """

    length_m: Positive | None = None


class SectionRecord(Record):
    """A section of netting, from front to back; its stretched circumference tapers linearly.

    ``shielding`` is the part of the drag of single twines that is left in this netting, ``twines``
    the number of them side by side in each bar.
    """

    name: str
    length_m: Positive
    front_circumference_m: Positive
    back_circumference_m: Positive
    mesh_m: Positive
    twine_diameter_m: Annotated[float, Field(gt=0, le=0.1)]
    twine_density_kg_m3: Annotated[float, Field(ge=500, le=8000)]
    twine_modulus_pa: Positive
    twines: Literal[1, 2] = 1
    knotless: bool = False
    shielding: Annotated[float, Field(gt=0, le=1)] = 1.0


class NettingRecord(Record):
    """The net: sections of diamond mesh, a codend, and how they are grouped; or its plan.

    With a ``plan`` sections, codend and wings are those of its pieces.

    ``around`` numerical meshes stand for the real ones of every row; a numerical row is as long
    as keeps the angle of the meshes. ``body`` sections become netting, the ``codend`` sections
    one line of ``codend_segments`` with the drag of its twine at the stated angle. Behind each
    stretched circumference of ``halved_at_circumference_m`` half as many numerical meshes go
    around as before it. ``bowing_pressure_pa`` is the load of the water across twine, per
    projected area, under which it bows between its knots; without it bars are straight.
    """

    around: Annotated[int, Field(ge=12, le=240, multiple_of=12)]
    halved_at_circumference_m: Annotated[tuple[Positive, ...], Field(max_length=4)] = ()
    body: Annotated[tuple[SectionRecord, ...], Field(max_length=30)] = ()
    codend: Annotated[tuple[SectionRecord, ...], Field(max_length=10)] = ()
    plan: NetPlanRecord | None = None
    codend_segments: Annotated[int, Field(ge=2, le=100)]
    codend_mesh_angle_deg: Annotated[float, Field(gt=0, lt=90)]
    damping_time_s: NotNegative
    normal_drag: NotNegative
    friction: NotNegative
    added_mass_normal: NotNegative
    knot_diameters: NotNegative
    knot_drag: NotNegative
    knot_added_mass: NotNegative
    wing_end_m: Positive | None = None
    wing_edge_hanging: Annotated[float, Field(gt=0.3, lt=1)] | None = None
    bowing_pressure_pa: NotNegative = 0.0

    @model_validator(mode='after')
    def _one_form(self) -> 'NettingRecord':
        outline = {
            'body': self.body or None,
            'codend': self.codend or None,
            'wing_end_m': self.wing_end_m,
            'wing_edge_hanging': self.wing_edge_hanging,
        }
        for key, value in outline.items():
            if self.plan is None and value is None:
                raise ValueError(f'{key}: missing, expected it, or a plan')
            if self.plan is not None and value is not None:
                raise ValueError(f'{key}: found beside a plan, expected one of them')
        return self


class KiteRecord(Record):
    """The canvas kite on the headrope's centre.

    Its rear carrying point lies ``chord_m`` of stretched netting behind the headrope.
    """

    area_m2: Positive
    mass_kg: NotNegative
    volume_m3: NotNegative
    setting_deg: Degrees
    chord_m: Positive
    lift_slope: NotNegative
    drag_base: NotNegative
    drag_growth: NotNegative


class ClumpRecord(Record):
    """A weight at each lower wing tip."""

    weight_in_water_n: NotNegative
    density_kg_m3: Annotated[float, Field(gt=1100)]
    drag_area_m2: NotNegative


class FloatRecord(Record):
    """Floats at each upper wing tip."""

    buoyancy_n: NotNegative
    density_kg_m3: Annotated[float, Field(gt=0, lt=900)]
    drag_area_m2: NotNegative


class SourceRecord(Record):
    """Source bag of an effect, with the SHA-256 of its recordings."""

    bag: str
    sha256: str


class ProvenanceRecord(Record):
    """Provenance of an effect: bags, the program's version, and the evidence for it."""

    found_by: str
    bags: tuple[SourceRecord, ...] = ()
    evidence: Numbers = FrozenDict()


class EffectRecord(Record):
    """An effect beyond the paper's model: its name in the catalogue, and its parameters."""

    name: str
    values: Numbers = FrozenDict()
    provenance: ProvenanceRecord | None = None


class GearRecord(Record):
    """Gear: the records of a whole gear file.

    Attributes
    ----------
    name
        Of the gear.
    water, ship, winch
        Density, gravity, current and temperature; towing blocks; speed of the winches.
    warp, bridle, headrope, footrope
        Ropes: lengths (m), diameters (m), weight in water (N/m), stiffness EA (N), drag.
    board
        Otter board: mass (kg), inertia (kg m²), area (m²), coefficients of eq. 14, fastening (m).
    netting
        Sections of the net, and how finely it is cut.
    kite, clump, floats
        Kite, weights and floats of the mouth.
    identification
        Start values, standard deviations and bounds of the twelve coefficients.
    effects
        Effects beyond the model, at most 20.

    Examples
    --------
    >>> import trawl_ros
    >>> gear = trawl_ros.load_gear('kaifuha')
    >>> gear.netting.around, gear.refined(net=0.25).netting.around
    (48, 12)
    """

    name: str
    water: WaterRecord
    ship: ShipRecord
    winch: WinchRecord
    warp: WarpRecord
    bridle: BridleRecord
    board: BoardRecord
    headrope: FrameRopeRecord
    footrope: FrameRopeRecord
    netting: NettingRecord
    side_rope: FrameRopeRecord | None = None
    kite: KiteRecord | None = None
    clump: ClumpRecord = ClumpRecord(weight_in_water_n=0.0, density_kg_m3=7800.0, drag_area_m2=0.0)
    floats: FloatRecord = FloatRecord(buoyancy_n=0.0, density_kg_m3=300.0, drag_area_m2=0.0)
    identification: StartRecord
    bridles: Annotated[tuple[OwnBridleRecord, ...], Field(max_length=6)] = (
        OwnBridleRecord(name='upper', at_board='upper', at_net='upper'),
        OwnBridleRecord(name='lower', at_board='lower', at_net='lower'),
    )
    hung: Annotated[tuple[HungRecord, ...], Field(max_length=100)] = ()
    effects: Annotated[tuple[EffectRecord, ...], Field(max_length=20)] = ()

    @model_validator(mode='before')
    @classmethod
    def _corrections(cls, data: object) -> object:
        if isinstance(data, dict) and 'identification' not in data:
            board = data.get('board')
            if isinstance(board, dict) and board.get('law') is not None:
                return {**data, 'identification': CORRECTIONS}
        return data

    @model_validator(mode='after')
    def _lengths(self) -> 'GearRecord':
        if self.netting.plan is None:
            for key in ('headrope', 'footrope'):
                if getattr(self, key).length_m is None:
                    raise ValueError(f'{key}.length_m: missing, expected a number (metres)')
        return self

    @model_validator(mode='after')
    def _rigged(self) -> 'GearRecord':
        names = [bridle.name for bridle in self.bridles]
        if len(set(names)) < len(names):
            raise ValueError(f'bridles: found the names {", ".join(names)}, expected each once')
        for end, expected in (('at_board', ('upper', 'lower')), ('at_net', ('upper', 'lower'))):
            missing = set(expected) - {getattr(bridle, end) for bridle in self.bridles}
            if missing:
                raise ValueError(
                    f'bridles: found none {end} {", ".join(sorted(missing))}, expected one at least'
                )
        ropes = ['headrope', 'footrope', 'side_rope', *(f'{name}_bridle' for name in names)]
        for number, item in enumerate(self.hung):
            if item.rope not in ropes:
                raise ValueError(
                    f'hung[{number}].rope: found {item.rope}, expected one of {", ".join(ropes)}'
                )
        return self

    def bridle_of(self, own: OwnBridleRecord) -> BridleRecord:
        """Make of one of the bridles."""
        return self.bridle.model_copy(update=own.changes)

    def refined(
        self, *, warp: int = 1, bridle: int = 1, net: float = 1.0, unjoined: bool = False
    ) -> 'GearRecord':
        """Copy of the gear cut finer; the net as nearly as a multiple of 12 meshes allows, and
        with ``unjoined`` as many meshes around its end as around its mouth.
        """
        halved_at = () if unjoined else self.netting.halved_at_circumference_m
        return self.model_copy(
            update={
                'warp': self.warp.model_copy(update={'segments': self.warp.segments * warp}),
                'bridle': self.bridle.model_copy(
                    update={'segments': self.bridle.segments * bridle}
                ),
                'bridles': tuple(
                    own
                    if own.segments is None
                    else own.model_copy(update={'segments': own.segments * bridle})
                    for own in self.bridles
                ),
                'netting': self.netting.model_copy(
                    update={
                        'around': 12 * round(self.netting.around * net / 12),
                        'halved_at_circumference_m': halved_at,
                        'codend_segments': round(self.netting.codend_segments * net),
                    }
                ),
            }
        )
