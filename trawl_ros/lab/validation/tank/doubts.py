# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Assumed numbers of the tank's net, each over its range, and the values that readings would need.

The ranges were fixed before any run.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from trawl_ros.core.errors import NoSteadyState
from trawl_ros.gear.net_plan import PieceRecord
from trawl_ros.gear.records import GearRecord
from trawl_ros.lab.report.doubts import need_in_words
from trawl_ros.lab.report.page import TextTable
from trawl_ros.lab.validation.tank.held import HeldNet, held
from trawl_ros.lab.validation.tank.states import FlumeState

SHOWN, SLOW = '64.0', '67.0'
"""Trials that are solved for each doubt: that by which twine was tuned, and the slowest of its
series, whose tensions together give an exponent."""

POINT_TOLERANCE_SHARE, EXPONENT_TOLERANCE = 0.1, 0.1
"""Share of a measured value within which a point is asked to be, and difference of exponents."""


COARSE = 0.5
"""Refinement of the net for doubts, as a share of that of the file."""


@dataclass(frozen=True)
class Doubt:
    """Assumed value of the tank's model, with the factors to vary it by.

    ``change`` scales the value by a factor, and ``low`` and ``high`` are the factors to try. If
    ``tank_twine`` is False, the twine has its drag at sea instead of that in the tank.
    """

    what: str
    change: Callable[[GearRecord, float], GearRecord] = lambda gear, factor: gear
    low: float = 1.0
    high: float = 1.0
    tank_twine: bool = True

    @property
    def factors(self) -> tuple[float, ...]:
        """Factors that are tried; NaN for twine that is not small."""
        if not self.tank_twine:
            return (math.nan,)
        return tuple(factor for factor in (self.low, self.high) if factor != 1.0)


def _pieces(
    change: Callable[[PieceRecord, float], dict[str, object]],
) -> Callable[[GearRecord, float], GearRecord]:
    def changed(gear: GearRecord, factor: float) -> GearRecord:
        plan = gear.netting.plan
        assert plan is not None
        pieces = tuple(p.model_copy(update=change(p, factor)) for p in plan.pieces)
        return gear.changed('netting', plan=plan.model_copy(update={'pieces': pieces}))

    return changed


def _twine(piece: PieceRecord, factor: float) -> dict[str, object]:
    return {'twine_diameter_mm': factor * (piece.twine_diameter_mm or 0.0)}


def _long(piece: PieceRecord, factor: float) -> dict[str, object]:
    back = piece.part == 'body'
    return {'long_meshes': factor * piece.long_meshes} if back else {}


def _around(piece: PieceRecord, factor: float) -> dict[str, object]:
    if piece.part == 'wing' and piece.pieces != 1:
        return {}
    return {
        'front_meshes': factor * piece.front_meshes, 'back_meshes': factor * piece.back_meshes
    }  # fmt: skip


def _key(part: str, name: str) -> Callable[[GearRecord, float], GearRecord]:
    def changed(gear: GearRecord, factor: float) -> GearRecord:
        return gear.changed(part, **{name: factor * getattr(getattr(gear, part), name)})

    return changed


def _floats(gear: GearRecord, factor: float) -> GearRecord:
    hung = tuple(
        item.model_copy(update={'buoyancy_n': factor * item.buoyancy_n}) for item in gear.hung
    )
    return gear.model_copy(update={'hung': hung})


DOUBTS = (
    Doubt('twine, thickness', _pieces(_twine), 0.6, 1.4),
    Doubt('knots, thickness', _key('netting', 'knot_diameters'), 0.5, 1.4),
    Doubt('friction along twine', _key('netting', 'friction'), 0.5, 4.0),
    Doubt('codend, angle of its meshes', _key('netting', 'codend_mesh_angle_deg'), 0.5, 2.0),
    Doubt('body, meshes along', _pieces(_long), 0.7, 1.4),
    Doubt('body, meshes around', _pieces(_around), 0.8, 1.25),
    Doubt('headrope, length', _key('headrope', 'length_m'), 1.0, 1.1),
    Doubt('headrope, weight', _key('headrope', 'weight_in_water_n_m'), 0.0, 2.0),
    Doubt('upper bridles, weight', _key('bridle', 'weight_in_water_n_m'), 0.0, 1.5),
    Doubt('floats (printed), buoyancy', _floats, 1.0, 2.0),
    Doubt('growth of drag at low Reynolds numbers', _key('netting', 'viscous'), 0.0, 1.0),
    Doubt('twine as large as at sea', tank_twine=False),
)


@dataclass(frozen=True)
class Doubted:
    """Doubt with the model's results at both ends, by factor; empty where nothing was found."""

    doubt: Doubt
    shown: dict[float, HeldNet | None]
    slow: dict[float, HeldNet | None]


def doubted(gear: GearRecord, states: Sequence[FlumeState]) -> list[Doubted]:
    """Solve both trials at both ends of every doubt."""
    by_trial = {state.trial: state for state in states}
    if not {SHOWN, SLOW} <= set(by_trial):
        return []
    gear = gear.refined(net=COARSE)

    def solved(doubt: Doubt | None, factor: float, trial: str) -> HeldNet | None:
        changed = gear if doubt is None else doubt.change(gear, factor)
        try:
            return held(changed, by_trial[trial], tank_twine=doubt is None or doubt.tank_twine)
        except NoSteadyState:
            return None

    as_is = {trial: solved(None, 1.0, trial) for trial in (SHOWN, SLOW)}
    found = []
    for doubt in DOUBTS:
        one = Doubted(doubt, {1.0: as_is[SHOWN]}, {1.0: as_is[SLOW]})
        for factor in doubt.factors:
            one.shown[factor] = solved(doubt, factor, SHOWN)
            one.slow[factor] = solved(doubt, factor, SLOW)
        found.append(one)
    return found


def _exponent(fast: HeldNet | None, slow: HeldNet | None) -> float:
    if fast is None or slow is None:
        return math.nan
    speeds = fast.found.point.speed / slow.found.point.speed
    return math.log(fast.tension / slow.tension) / math.log(speeds)


def _values(net: HeldNet | None) -> tuple[str, str, str]:
    if net is None:
        return '–', '–', '–'
    return f'{net.spread:.2f}', f'{net.height:.2f}', f'{1e-3 * net.tension:.2f}'


def doubts_table(every: Sequence[Doubted], states: Sequence[FlumeState]) -> TextTable:
    """Return a table of every doubt with its results, and the factors that the readings need."""
    by_trial = {state.trial: state for state in states}
    tank, slow = by_trial[SHOWN], by_trial[SLOW]
    power = math.log(tank.tension / slow.tension) / math.log(tank.speed / slow.speed)
    lines = [
        (
            'tank', '', f'{tank.spread:.2f}', f'{tank.height:.2f}', f'{1e-3 * tank.tension:.2f}',
            f'{power:.2f}', '', '',
        )
    ]  # fmt: skip
    for one in every:
        heights = {f: math.nan if net is None else net.height for f, net in one.shown.items()}
        powers = {f: _exponent(net, one.slow[f]) for f, net in one.shown.items()}
        needs = (
            ('', '')
            if not one.doubt.tank_twine
            else (
                need_in_words(heights, tank.height, POINT_TOLERANCE_SHARE),
                need_in_words(powers, power, EXPONENT_TOLERANCE / power),
            )
        )
        if one is every[0]:
            lines.append(
                ('as in the file', '', *_values(one.shown[1.0]), f'{powers[1.0]:.2f}', '', '')
            )
        for factor in one.doubt.factors:
            exponent = powers[factor]
            lines.append(
                (
                    one.doubt.what,
                    '' if math.isnan(factor) else f'× {factor:g}',
                    *_values(one.shown[factor]),
                    '–' if math.isnan(exponent) else f'{exponent:.2f}',
                    *needs,
                )
            )
    return TextTable(
        'Assumed numbers, each changed alone, with a net half as fine: '
        f'trial {SHOWN}, and the exponent of tension from trial {SLOW} to it. The last columns '
        'give the factors on the number, of those tried, with which the height comes within '
        f'{100 * POINT_TOLERANCE_SHARE:g} % of the tank and the exponent within 0.1.',
        (
            'number', 'factor', 'spread (m)', 'height (m)', 'tension (kN)', 'exponent',
            'height needs', 'exponent needs',
        ),
        tuple(lines),
    )  # fmt: skip
