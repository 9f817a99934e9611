# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Findings in a gear file: values that look wrong, by arithmetic, without building the model."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from math import pi

import numpy as np

from trawl_ros.gear.board_parameters import CORRECTED, CORRECTIONS
from trawl_ros.gear.boards import FasteningRecord, plate_inertia
from trawl_ros.gear.net_plan import NetPlanRecord, PieceRecord, cut_slope
from trawl_ros.gear.netting import NettingRecord
from trawl_ros.gear.records import GearRecord
from trawl_ros.gear.rigging import RopeRecord

JOIN_TOLERANCE = 0.15
"""Greatest relative difference of two joined edges; a net maker can gather this much netting."""

CUT_TOLERANCE = 0.15
"""Greatest difference of a piece's counts from its cutting rate, as a part of the lost meshes."""

WIRE_WEIGHT_TOLERANCE = 0.35
"""Greatest relative difference of a warp's weight from that of steel wire of its diameter."""

FRAME_ROPE_RATIO = (0.6, 1.6)
"""Range of the headrope's length over the footrope's."""

LONGEST_BRIDLE_M = 1000.0
"""Greatest length of a bridle; with sweeps they are some hundred metres long."""

STEEL_WEIGHT_N_M3 = 3.1e4
"""Weight in water per length of steel wire rope over its squared diameter."""

STEEL_EA_PA = 4.0e10
"""EA of steel wire rope over its squared diameter."""


@dataclass(frozen=True)
class GearFinding:
    """Finding in a gear file: a key, with its found and expected values in a sentence."""

    key: str
    sentence: str

    def __str__(self) -> str:
        return f'{self.key}: {self.sentence}'


def findings(gear: GearRecord) -> tuple[GearFinding, ...]:
    """Find values that look wrong in a gear file.

    Parameters
    ----------
    gear
        Loaded gear; loading has refused impossible values already.

    Returns
    -------
    tuple of GearFinding
        Findings in the order of the file; empty if there are none.
    """
    return tuple(finding for part in (_ropes, _net, _rigging, _board) for finding in part(gear))


def _ropes(gear: GearRecord) -> Iterator[GearFinding]:
    wire = STEEL_WEIGHT_N_M3 * gear.warp.diameter_m**2
    warp = gear.warp.weight_in_water_n_m
    if 0.5 * wire <= warp and not abs(warp / wire - 1.0) <= WIRE_WEIGHT_TOLERANCE:
        yield GearFinding(
            'warp.weight_in_water_n_m',
            f'found {warp:g} N/m, expected about {wire:.3g} N/m for steel wire of '
            f'{1e3 * gear.warp.diameter_m:.3g} mm; or another diameter_m',
        )
    head, foot = gear.headrope.length_m, gear.footrope.length_m
    if head and foot and not FRAME_ROPE_RATIO[0] <= head / foot <= FRAME_ROPE_RATIO[1]:
        yield GearFinding(
            'headrope.length_m',
            f'found {head:g} m and a footrope of {foot:g} m, expected {FRAME_ROPE_RATIO[0]:g} to '
            f'{FRAME_ROPE_RATIO[1]:g} times the footrope',
        )
    for key in ('warp', 'bridle'):
        rope = getattr(gear, key)
        steel = STEEL_EA_PA * rope.diameter_m**2
        if rope.weight_in_water_n_m > 0.5 * 4e4 * rope.diameter_m**2 and not (
            0.4 * steel < rope.stiffness_n < 2.5 * steel
        ):
            yield GearFinding(
                f'{key}.stiffness_n',
                f'found {rope.stiffness_n:.3g} N, expected about {steel:.3g} N for a wire of '
                f'{1e3 * rope.diameter_m:.3g} mm',
            )
        elif 0.4 * steel < rope.stiffness_n < 2.5 * steel:
            yield from _light_wire(key, rope)
        mass = rope.weight_in_water_n_m / 9.81 + 1025.0 * pi / 4 * rope.diameter_m**2
        if mass > 6500.0 * pi / 4 * rope.diameter_m**2:
            yield GearFinding(
                f'{key}.weight_in_water_n_m',
                f'found {rope.weight_in_water_n_m:g} N/m, more than a wire of '
                f'{1e3 * rope.diameter_m:.3g} mm can weigh',
            )
        elif mass < 400.0 * pi / 4 * rope.diameter_m**2:
            yield GearFinding(
                f'{key}.weight_in_water_n_m',
                f'found {rope.weight_in_water_n_m:g} N/m, more buoyancy than a fibre rope of '
                f'{1e3 * rope.diameter_m:.3g} mm can have',
            )


def _light_wire(key: str, rope: RopeRecord) -> Iterator[GearFinding]:
    """Find a rope with the stiffness of a wire that is much lighter."""
    usual = STEEL_WEIGHT_N_M3 * rope.diameter_m**2
    found = rope.weight_in_water_n_m
    if found < 0.5 * usual:
        in_kilograms = 0.5 < 9.81 * found / usual < 2.0
        yield GearFinding(
            f'{key}.weight_in_water_n_m',
            f'found {found:g} N/m for a rope as stiff as a wire of {1e3 * rope.diameter_m:.3g} mm, '
            f'expected about {usual:.3g} N/m'
            + (f' ({found:g} kg/m would be {9.81 * found:.3g} N/m)' if in_kilograms else ''),
        )


def _net(gear: GearRecord) -> Iterator[GearFinding]:
    net = gear.netting
    if net.plan is None:
        yield from _sections(gear, net)
    else:
        yield from _plan(gear, net.plan)


def _sections(gear: GearRecord, net: NettingRecord) -> Iterator[GearFinding]:
    sections = [
        (f'netting.{part}[{n}]', section)
        for part in ('body', 'codend')
        for n, section in enumerate(getattr(net, part))
    ]
    for (_, ahead), (key, behind) in pairwise(sections):
        yield from _join(key, ahead.back_circumference_m, behind.front_circumference_m)
    for key, section in sections:
        yield from _twine(key, section.twine_diameter_m, section.mesh_m)
    mouth = net.body[0].front_circumference_m
    if net.wing_edge_hanging is not None:
        # Wings are 1/24 of the mouth long; both bosoms together take two thirds of it.
        edge, bosom = net.wing_edge_hanging * mouth / 24, mouth / 3
        for key in ('headrope', 'footrope'):
            length = getattr(gear, key).length_m
            left = length - 2 * edge
            if left <= 0.0:
                yield GearFinding(
                    f'{key}.length_m',
                    f'found {length:g} m, expected more than its wing edges of {2 * edge:.4g} m',
                )
            else:
                yield from _hanging(f'{key}.length_m', left / bosom, f'{left:.4g} m for its bosom')


def _hanging(key: str, ratio: float, rope: str) -> Iterator[GearFinding]:
    if not 0.2 <= ratio <= 0.9:
        yield GearFinding(
            key, f'leaves {rope}, a hanging ratio of {ratio:.2f}, expected 0.2 to 0.9'
        )


def _join(key: str, ahead: float, behind: float) -> Iterator[GearFinding]:
    if not 1 / (1 + JOIN_TOLERANCE) <= behind / ahead <= 1 + JOIN_TOLERANCE:
        yield GearFinding(
            key,
            f'found a front edge of {behind:.4g} m (stretched) behind an edge of {ahead:.4g} m, '
            f'expected them within {100 * JOIN_TOLERANCE:.0f} % of each other',
        )


def _twine(key: str, diameter: float, mesh: float) -> Iterator[GearFinding]:
    ratio = diameter / (0.5 * mesh)
    if not 5e-4 <= ratio <= 0.25:
        yield GearFinding(
            key,
            f'found twine of {1e3 * diameter:.3g} mm, {ratio:.2g} of a bar of {500 * mesh:.4g} mm, '
            'expected 0.0005 to 0.25',
        )


def _plan(gear: GearRecord, plan: NetPlanRecord) -> Iterator[GearFinding]:
    number = {id(piece): f'netting.plan.pieces[{n}]' for n, piece in enumerate(plan.pieces)}
    for piece in plan.pieces:
        key = number[id(piece)]
        if piece.orientation != 'ropes':
            yield from _twine(key, piece.twine.diameter, piece.mesh)
        yield from _cut(key, piece)
        filled = piece.twine.tex / piece.twine.fibre.density / piece.twine.section
        if not 0.35 <= filled <= 1.0:
            yield GearFinding(
                key,
                f'found Rtex and diameter that disagree: fibres fill {filled:.2f} of a twine of '
                f'{1e3 * piece.twine.diameter:.3g} mm, expected 0.35 to 1',
            )
    rows = [pieces for part in ('body', 'codend') for _, pieces in plan.sections(part)]
    for ahead, behind in pairwise(rows):
        if (ahead[0].orientation == 'square') != (behind[0].orientation == 'square'):
            continue  # stretched meshes are joined to open ones by count
        if ahead[0].orientation == 'ropes':
            continue  # ropes may converge or diverge from the frame to the netting
        key = number[id(behind[0])]
        if {p.panel for p in ahead} == {p.panel for p in behind}:
            back = {p.panel: p.widths[1] for p in ahead}
            for piece in behind:
                yield from _join(number[id(piece)], back[piece.panel], piece.widths[0])
        else:
            yield from _join(
                key,
                sum(p.count * p.widths[1] for p in ahead),
                sum(p.count * p.widths[0] for p in behind),
            )
    for rope in ('headrope', 'footrope', 'side_rope'):
        record = getattr(gear, rope)
        if record is not None and record.length_m is not None:
            yield from _edges(rope, record.length_m, plan)
    long = {name: plan.wing_length(name) for name in ('upper', 'side_upper', 'side_lower', 'lower')}
    for side, panel in (('side_upper', 'upper'), ('side_lower', 'lower')):
        if long[side] and abs(long[side] - long[panel]) > 0.05 * long[panel]:
            yield GearFinding(
                f'netting.plan ({side} wing)',
                f'found {long[side]:.4g} m, expected the length of the {panel} wing, '
                f'{long[panel]:.4g} m',
            )


def _cut(key: str, piece: PieceRecord) -> Iterator[GearFinding]:
    if piece.cut is None:
        return
    edges = 1 if piece.part == 'wing' else 2
    expected = edges * cut_slope(piece.cut) * piece.long_meshes
    found = abs(piece.front_meshes - piece.back_meshes)
    if abs(found - expected) > max(CUT_TOLERANCE * expected, 2.0):
        yield GearFinding(
            key,
            f'found {piece.front_meshes:g} to {piece.back_meshes:g} meshes over '
            f'{piece.long_meshes:g}, a difference of {found:g}, expected {expected:.3g} from the '
            f'cut {piece.cut}',
        )


def _edges(rope: str, length: float, plan: NetPlanRecord) -> Iterator[GearFinding]:
    netting, hanging = plan.hung_netting(rope), plan.hanging
    left = length - hanging.bosom * netting['bosom'] - hanging.wing_tip * netting['tip']
    if netting['edge'] and not 0.7 <= left / netting['edge'] <= 1.05:
        yield GearFinding(
            f'{rope}.length_m',
            f'found {length:g} m, which leaves {left:.4g} m for {netting["edge"]:.4g} m of wing '
            f'edges, a ratio of {left / netting["edge"]:.2f}, expected 0.7 to 1.05',
        )


def _rigging(gear: GearRecord) -> Iterator[GearFinding]:
    long = {own.name: gear.bridle_of(own).length_m for own in gear.bridles}
    for name, length in long.items():
        if length > LONGEST_BRIDLE_M:
            yield GearFinding(
                f'bridles ({name})',
                f'found {length:g} m, expected at most {LONGEST_BRIDLE_M:g} m',
            )
    if max(long.values()) > 1.15 * min(long.values()):
        told = ', '.join(f'{name} {length:g} m' for name, length in long.items())
        yield GearFinding('bridles', f'found {told}, expected them within 15 % of each other')
    sinks = gear.clump.weight_in_water_n > 0.0 or any(item.sinks for item in gear.hung)
    if not sinks and gear.footrope.weight_in_water_n_m <= 0.0:
        yield GearFinding(
            'hung', 'found no weight on net or bridles, expected one that opens the mouth downward'
        )


def _board(gear: GearRecord) -> Iterator[GearFinding]:
    if gear.pair is not None:
        return
    board = gear.board
    if board.parameters is CORRECTED:
        yield from _corrections(gear)
    plate = board.span_m * board.chord_m
    if not 0.7 <= board.area_m2 / plate <= 1.15:
        yield GearFinding(
            'board.area_m2',
            f'found {board.area_m2:g} m², expected about span times chord, {plate:.4g} m²',
        )
    density = board.mass_kg / board.volume_m3
    if not 1025.0 < density <= 8000.0:
        yield GearFinding(
            'board.volume_m3',
            f'found {board.volume_m3:g} m³ for {board.mass_kg:g} kg, a density of {density:.0f} '
            'kg/m³, expected more than sea water and no more than steel',
        )
    usual = plate_inertia(board.mass_kg, board.volume_m3, board.span_m, board.chord_m)
    for name in ('xx_kg_m2', 'yy_kg_m2', 'zz_kg_m2'):
        found = getattr(board.inertia, name)
        if not 1 / 3 <= found / usual[name] <= 3:
            yield GearFinding(
                f'board.inertia.{name}',
                f'found {found:g}, expected about that of a plate, {usual[name]:.4g}',
            )
    points = board.fastening
    for name in FasteningRecord.model_fields:
        x, _, z = getattr(points, name)
        if abs(x) > 0.75 * board.chord_m or abs(z) > 0.75 * board.span_m:
            yield GearFinding(
                f'board.fastening.{name}',
                f'found {x:g} m ahead and {z:g} m up, expected a point near the board of '
                f'{board.chord_m:g} by {board.span_m:g} m',
            )
    if points.upper_bridle_m[2] <= points.lower_bridle_m[2]:
        yield GearFinding(
            'board.fastening', 'found the upper bridle below the lower one, expected it above'
        )
    if points.warp_m[0] <= max(points.upper_bridle_m[0], points.lower_bridle_m[0]):
        yield GearFinding(
            'board.fastening.warp_m', 'found it behind a bridle, expected it ahead of both'
        )


def _corrections(gear: GearRecord) -> Iterator[GearFinding]:
    """Find coefficients and a prior that look like those of a board without a law."""
    usual = np.array(CORRECTIONS.std)
    for key, values in (
        ('board.coefficients', gear.board.coefficients.array()),
        ('identification.start', np.array(gear.identification.start)),
    ):
        if np.any(np.abs(values) > 2.0 * usual):
            yield GearFinding(
                key,
                'found numbers as of a board without a law, expected corrections near zero with '
                f'board.law; delete {key.removesuffix(".start")} if they '
                'describe another board',
            )
