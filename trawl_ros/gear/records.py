# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Records of the gear file: every key has its unit, every value is checked on load."""

from typing import Annotated

from pydantic import Field, ValidationError, model_validator

from trawl_ros.core.errors import GearError
from trawl_ros.core.schema import FrozenDict, Numbers, Record
from trawl_ros.gear.board_parameters import (
    CORRECTIONS,
    EQ14,
    CoefficientsRecord,
    StartRecord,
)
from trawl_ros.gear.boards import BoardRecord, FasteningRecord, parameters_of, plate_inertia
from trawl_ros.gear.catch import CatchRecord
from trawl_ros.gear.netting import NettingRecord
from trawl_ros.gear.numbers import Degrees, NotNegative, Positive
from trawl_ros.gear.rigging import (
    ENDS,
    BridleRecord,
    FrameRopeRecord,
    HungRecord,
    OwnBridleRecord,
    SweepRecord,
    WarpRecord,
)
from trawl_ros.gear.sea_water import WaterRecord

PLATE_DENSITY_KG_M3 = 7850.0
"""Density of the towing plate and its shackles."""

PLATE_WARP_AHEAD_M, PLATE_BRIDLES_AHEAD_M, PLATE_BRIDLES_UP_M = 0.3, -0.2, 0.25
"""Holes of the towing plate from its middle; bridles are above and below. Assumed."""


class ShipRecord(Record):
    """Ship: spacing of the towing blocks, and limits of acceleration and turning.

    A pair trawl has the distance of both ships instead of the spacing, see `PairRecord`.
    """

    block_spacing_m: Annotated[float, Field(gt=0, le=50)] | None = None
    """Distance of the two towing blocks; needed unless the file has a `pair`."""
    max_acceleration_m_s2: Annotated[float, Field(gt=0, le=1)]
    """Most by which the speed of the ship changes."""
    max_turn_acceleration_deg_s2: Annotated[float, Field(gt=0, le=5)]
    """Most by which her rate of turn changes."""


class WinchRecord(Record):
    """Limits of a winch's speed and acceleration."""

    max_speed_m_s: Annotated[float, Field(gt=0, le=5)]
    """Greatest speed of the wire."""
    max_acceleration_m_s2: Annotated[float, Field(gt=0, le=5)]
    """Greatest acceleration of the wire."""


class KiteRecord(Record):
    """Canvas kite on the headrope's centre."""

    area_m2: Annotated[float, Field(gt=0, le=1000)]
    """Area of the canvas."""
    mass_kg: NotNegative
    """Mass with its ropes."""
    volume_m3: NotNegative
    """Displaced volume of canvas and ropes."""
    setting_deg: Degrees
    """Angle to the flow at which its legs hold it."""
    chord_m: Positive | None = None
    """With it, the kite pitches with the line to a point this length of stretched netting behind
    the headrope.
    """
    normal_slope: NotNegative
    """Slope k of the normal coefficient, per radian of attack."""
    normal_limit: Positive
    """Limit N of the normal coefficient."""
    drag_base: NotNegative
    """Drag coefficient C_0 at zero attack."""


class PairRecord(Record):
    """Pair trawl: two ships abreast that tow one net without boards; its plates have no drag."""

    distance_m: Annotated[float, Field(gt=10, le=2000)]
    """Distance of the two ships, from block to block."""
    plate_mass_kg: Annotated[float, Field(gt=1, le=5000)] = 60.0
    """Mass of the steel plate, with shackles, between a warp and its bridles."""


def towing_plate(pair: PairRecord) -> BoardRecord:
    """Return the plate as a body in place of a board, without hydrodynamic loads."""
    long, high = PLATE_WARP_AHEAD_M - PLATE_BRIDLES_AHEAD_M, 2 * PLATE_BRIDLES_UP_M
    volume = pair.plate_mass_kg / PLATE_DENSITY_KG_M3
    return BoardRecord.model_validate(
        {
            'mass_kg': pair.plate_mass_kg,
            'volume_m3': volume,
            'inertia': plate_inertia(pair.plate_mass_kg, volume, high, long),
            # So small that corrections to its coefficients, all zero, have no effect.
            'area_m2': 1e-6,
            'span_m': high,
            'chord_m': long,
            'coefficients': CoefficientsRecord(**dict.fromkeys(EQ14.names, 0.0)),
            'rotary_slope': 0.0,
            'fastening': FasteningRecord(
                warp_m=(PLATE_WARP_AHEAD_M, 0.0, 0.0),
                upper_bridle_m=(PLATE_BRIDLES_AHEAD_M, 0.0, PLATE_BRIDLES_UP_M),
                lower_bridle_m=(PLATE_BRIDLES_AHEAD_M, 0.0, -PLATE_BRIDLES_UP_M),
            ),
        }
    )


class ClumpRecord(Record):
    """Weight at each lower wing tip."""

    weight_in_water_n: NotNegative
    """Weight in water, of each."""
    density_kg_m3: Annotated[float, Field(gt=1100, le=25_000)]
    """Density of its material."""
    drag_area_m2: NotNegative
    """Drag coefficient times area."""


class FloatRecord(Record):
    """Floats at each upper wing tip."""

    buoyancy_n: NotNegative
    """Buoyancy on each side, less the weight of the floats."""
    density_kg_m3: Annotated[float, Field(ge=1, lt=900)]
    """Mass of the floats over their volume."""
    drag_area_m2: NotNegative
    """Drag coefficient times area."""


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
    """Effect beyond the paper's model: its name in the catalogue, and its parameters."""

    name: str
    """Name of the effect, as in `trawl effects`."""
    values: Numbers = FrozenDict()
    """Its parameters by name."""
    provenance: ProvenanceRecord | None = None
    """Bags and evidence by which a diagnosis found it; written by `trawl diagnose`."""


class GearRecord(Record):
    """Gear: the records of a whole gear file.

    Examples
    --------
    >>> import trawl_ros
    >>> gear = trawl_ros.load_gear('kaifuha')
    >>> gear.netting.around, gear.refined(net=0.25).netting.around
    (48, 12)
    """

    name: str
    """Name of the gear."""
    water: WaterRecord
    """Density, gravity, current and temperature of the sea."""
    ship: ShipRecord
    """Towing blocks and limits of the ship."""
    winch: WinchRecord
    """Limits of either winch."""
    warp: WarpRecord
    """Warps, whose length is commanded."""
    bridle: BridleRecord
    """Make of all bridles."""
    board: BoardRecord
    """Otter boards."""
    pair: PairRecord | None = None
    """Two ships in place of boards."""
    headrope: FrameRopeRecord
    """Headrope."""
    footrope: FrameRopeRecord
    """Footrope with its chain."""
    netting: NettingRecord
    """Net: sections or a plan, and its numerical mesh."""
    side_rope: FrameRopeRecord | None = None
    """Rope from upper to lower wing tip; default as the headrope."""
    kite: KiteRecord | None = None
    """Kite on the middle of the headrope."""
    catch: CatchRecord | None = None
    """Catch in the codend."""
    clump: ClumpRecord = ClumpRecord(weight_in_water_n=0.0, density_kg_m3=7800.0, drag_area_m2=0.0)
    """Weight at each lower wing tip."""
    floats: FloatRecord = FloatRecord(buoyancy_n=0.0, density_kg_m3=300.0, drag_area_m2=0.0)
    """Floats at each upper wing tip."""
    identification: StartRecord
    """Prior of the board's coefficients; needed without a `law` and for `heel`."""
    sweep: SweepRecord | None = None
    """Rope between boards and bridles, with backstrops."""
    bridles: Annotated[tuple[OwnBridleRecord, ...], Field(max_length=6)] = (
        OwnBridleRecord(name='upper', at_board='upper', at_net='upper'),
        OwnBridleRecord(name='lower', at_board='lower', at_net='lower'),
    )
    """One entry per bridle of a side."""
    hung: Annotated[tuple[HungRecord, ...], Field(max_length=100)] = ()
    """Weights, chain, floats and kites on ropes."""
    effects: Annotated[tuple[EffectRecord, ...], Field(max_length=20)] = ()
    """Physics that the model lacks."""

    @model_validator(mode='before')
    @classmethod
    def _usual_prior(cls, data: object) -> object:
        if isinstance(data, dict) and 'identification' not in data:
            board = data.get('board')
            own = parameters_of(board.get('law') if isinstance(board, dict) else None)
            prior = CORRECTIONS if data.get('pair') is not None else own.prior
            if prior is not None:
                return {**data, 'identification': prior}
        return data

    @model_validator(mode='before')
    @classmethod
    def _plates(cls, data: object) -> object:
        if not isinstance(data, dict) or data.get('pair') is None or 'board' in data:
            return data
        try:
            pair = PairRecord.model_validate(data['pair'])
        except ValidationError:  # the validation of `pair` reports its keys
            pair = PairRecord(distance_m=100.0)
        return {**data, 'board': towing_plate(pair)}

    @model_validator(mode='before')
    @classmethod
    def _forked(cls, data: object) -> object:
        if not isinstance(data, dict) or data.get('sweep') is None or 'bridles' in data:
            return data
        forks = tuple(OwnBridleRecord(name=end, at_net=end) for end in ENDS)
        return {**data, 'bridles': forks}

    @model_validator(mode='after')
    def _prior_of_parameters(self) -> 'GearRecord':
        if faults := list(self.board.parameters.faults_of_prior(self.identification)):
            raise ValueError('\n'.join(faults))
        return self

    @model_validator(mode='after')
    def _one_or_two_ships(self) -> 'GearRecord':
        spacing = self.ship.block_spacing_m
        if self.pair is None:
            if spacing is None:
                raise ValueError('ship.block_spacing_m: missing, expected a number (metres)')
            return self
        if spacing is not None:
            raise ValueError(
                f'ship.block_spacing_m: found {spacing:g} together with a pair, expected only '
                'pair.distance_m'
            )
        if self.board != towing_plate(self.pair):
            raise ValueError('board: found together with a pair, expected one of them')
        return self

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
        for number, bridle in enumerate(self.bridles):
            if self.sweep is None and bridle.at_board is None:
                raise ValueError(f'bridles[{number}].at_board: missing, expected upper or lower')
            if self.sweep is not None and bridle.at_board is not None:
                raise ValueError(
                    f'bridles[{number}].at_board: found {bridle.at_board} together with a sweep, '
                    'expected none: all bridles begin at the end of the sweep'
                )
        for end in ('at_net',) if self.sweep is not None else ('at_board', 'at_net'):
            missing = set(ENDS) - {getattr(bridle, end) for bridle in self.bridles}
            if missing:
                raise ValueError(
                    f'bridles: found none {end} {", ".join(sorted(missing))}, expected at least one'
                )
        ropes = ['headrope', 'footrope', 'side_rope', *(f'{name}_bridle' for name in names)]
        if self.sweep is not None:
            ropes.append('sweep')
        for number, item in enumerate(self.hung):
            if item.rope not in ropes:
                raise ValueError(
                    f'hung[{number}].rope: found {item.rope}, expected one of {", ".join(ropes)}'
                )
        return self

    @property
    def block_distance(self) -> float:
        """Distance (m) of the two towing blocks, on one ship or on the two ships of a pair."""
        spacing = self.ship.block_spacing_m if self.pair is None else self.pair.distance_m
        assert spacing is not None
        return spacing

    @property
    def behind_boards(self) -> float:
        """Length (m) of the longest path along ropes from a board to the net."""
        ahead = 0.0
        if self.sweep is not None:
            backstrops = self.sweep.upper_backstrop_m, self.sweep.lower_backstrop_m
            ahead = max(backstrops) + self.sweep.length_m
        return ahead + max(self.bridle_of(own).length_m for own in self.bridles)

    def require_boards(self, what: str) -> None:
        """Refuse a gear without boards.

        Raises
        ------
        GearError
            For a pair trawl; ``what`` says why the boards are needed.
        """
        if self.pair is not None:
            raise GearError(
                f"'{self.name}' is towed by two ships and has no boards, {what}; expected a gear "
                'with boards'
            )

    def bridle_of(self, own: OwnBridleRecord | SweepRecord) -> BridleRecord:
        """Return the properties of a bridle, or of the sweep."""
        return self.bridle.model_copy(update=own.changes)

    def changed(self, part: str, **keys: object) -> 'GearRecord':
        """Return a copy of the gear with other values of some keys of a part.

        ``changed('netting', around=24)`` gives a net with 24 meshes around, and rows that match.
        """
        return self.model_copy(update={part: getattr(self, part).model_copy(update=keys)})

    def refined(
        self, *, warp: int = 1, bridle: int = 1, net: float = 1.0, unjoined: bool = False
    ) -> 'GearRecord':
        """Return a copy of the gear with a finer numerical mesh.

        Parameters
        ----------
        warp, bridle, net
            Factors on the segments of warps and bridles and on the meshes of the net, which are
            rounded to a multiple of 12.
        unjoined
            True for a net with the same number of meshes around its end as around its mouth.
        """
        halved_at = () if unjoined else self.netting.halved_at_circumference_m
        return self.model_copy(
            update={
                'warp': self.warp.model_copy(update={'segments': self.warp.segments * warp}),
                'bridle': self.bridle.model_copy(
                    update={'segments': self.bridle.segments * bridle}
                ),
                'sweep': self.sweep
                and self.sweep.model_copy(
                    update={'segments': self.bridle_of(self.sweep).segments * bridle}
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
