# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Shape of the gear at a moment, from the best source in a bag: markers, truth, or readings."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.colors import to_rgb
from scipy.spatial.transform import Rotation

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.rotations import to_quaternion
from trawl_ros.gear.records import GearRecord
from trawl_ros.plots.moments import GEAR, MOUTH, Moment, corners
from trawl_ros.plots.records import SCHOOLS, GearShape, Strand, TowHistory
from trawl_ros.records.topics import VESSEL, WINCH_NAMES
from trawl_ros.records.truth import SIDES
from trawl_ros.report.style import NETTING, PORT, STARBOARD

FROM_MARKERS = 'truth'
FROM_TRUTH = 'truth of doors and mouth; warps and bridles drawn straight'
FROM_READINGS = 'as measured; warps drawn straight, the mouth one bridle behind the doors'

COLOURS = dict(zip(SIDES, (PORT, STARBOARD), strict=True))
RING = 36
"""Number of pieces of a section through a school of fish."""

READING_AWAY_S = 30.0
"""Longest time between a picture and a reading that is used for it."""


def gear_shape(moment: Moment, tow: TowHistory, gear: GearRecord) -> GearShape | None:
    """Return the shape of the gear at a moment; None if the bag holds too little to draw it.

    ``gear`` gives the dimensions that straight lines need: distance of the blocks, size of the
    doors, length of the bridles.
    """
    if GEAR in moment.messages:
        return _from_markers(moment, tow)
    doors = [_true_door(tow, side, moment.time) for side in SIDES]
    if MOUTH in moment.messages and all(door is not None for door in doors):
        return _from_truth(moment, tow, gear, [door for door in doors if door is not None])
    return _from_readings(moment.time, tow, gear)


def _from_markers(moment: Moment, tow: TowHistory) -> GearShape | None:
    strands = [strand for marker in moment.messages[GEAR].markers for strand in strands_of(marker)]
    blocks = [strand.pieces[0, 0] for strand in strands if strand.name in WINCH_NAMES]
    if not blocks:
        return None
    origin = np.mean(blocks, axis=0)
    heading = tow.best('heading')
    yaw = math.nan if heading is None else heading.at(moment.time)
    if not math.isfinite(yaw):
        pulled = [strand.pieces for strand in strands if strand.name not in (VESSEL, SCHOOLS)]
        middle = np.concatenate([pieces.reshape(-1, 3) for pieces in pulled]).mean(axis=0)
        yaw = math.atan2(*(origin - middle)[1::-1])
    return GearShape(
        moment.time,
        tuple(_in_ships_axes(strand, origin, yaw) for strand in strands),
        FROM_MARKERS,
        by_tension=True,
    )


def strands_of(marker: Any) -> list[Strand]:
    """Strands of a marker: lines as they are, plates and ellipsoids as outlines."""
    points = np.array([[p.x, p.y, p.z] for p in marker.points]).reshape(-1, 3)
    if marker.type == marker.LINE_STRIP:
        pieces = chain(points)
    elif marker.type == marker.LINE_LIST:
        pieces = points.reshape(-1, 2, 3)
    elif marker.type == marker.CUBE:
        place, turn = marker.pose.position, marker.pose.orientation
        pieces = plate(
            np.array([place.x, place.y, place.z]),
            Rotation.from_quat([turn.x, turn.y, turn.z, turn.w]).as_matrix(),
            (marker.scale.x, marker.scale.z),
        )
    elif marker.type == marker.SPHERE:
        pieces = _rings(marker)
    else:
        return []
    per_piece = marker.colors[::2] if len(marker.colors) else [marker.color] * len(pieces)
    colours = np.array([[colour.r, colour.g, colour.b] for colour in per_piece])
    return [Strand(marker.ns, pieces, colours.reshape(-1, 3))]


def plate(middle: FloatArray, axes: FloatArray, size: tuple[float, float]) -> FloatArray:
    """Outline (4, 2, 3) of a plate of (length along x, height along z)."""
    along, up = 0.5 * size[0] * axes[:, 0], 0.5 * size[1] * axes[:, 2]
    ring = middle + np.array([along + up, along - up, -along - up, -along + up, along + up])
    return chain(ring)


def _rings(marker: Any) -> FloatArray:
    """Outlines (n, 2, 3) of an ellipsoid with axes along those of ``map``: its three sections."""
    place, size = marker.pose.position, marker.scale
    turn = np.linspace(0.0, 2.0 * np.pi, RING + 1)
    circle = np.column_stack([np.cos(turn), np.sin(turn), 0.0 * turn])
    return np.concatenate(
        [
            chain(
                np.array([place.x, place.y, place.z])
                + 0.5 * np.array([size.x, size.y, size.z]) * np.roll(circle, axis, axis=1)
            )
            for axis in range(3)
        ]
    )


def _true_door(tow: TowHistory, side: str, time: float) -> tuple[FloatArray, FloatArray] | None:
    """Position (3,) in ``map`` and axes (3, 3) of a door; its yaw is assumed to be the ship's."""
    names = [f'{side}_{axis}' for axis in 'xyz']
    if not all(name in tow.truth for name in names) or 'heading' not in tow.truth:
        return None
    place = np.array([tow.truth[name].at(time) for name in names])
    roll, pitch, yaw = (
        tow.truth[name].at(time) for name in (f'{side}_roll', f'{side}_pitch', 'heading')
    )
    return place, Rotation.from_quat(to_quaternion(roll, pitch, yaw)).as_matrix()


def _from_truth(
    moment: Moment,
    tow: TowHistory,
    gear: GearRecord,
    doors: Sequence[tuple[FloatArray, FloatArray]],
) -> GearShape | None:
    ship = [tow.truth[name].at(moment.time) for name in ('east', 'north', 'heading')]
    if not all(math.isfinite(value) for value in ship):
        return None
    origin, yaw = np.array([*ship[:2], 0.0]), ship[2]
    port = np.array([-math.sin(yaw), math.cos(yaw), 0.0])
    mouth = corners(moment)
    half = len(mouth) // 2
    strands = [
        _one_colour('headrope', chain(mouth[:half]), NETTING),
        _one_colour('footrope', chain(mouth[half:]), NETTING),
    ]
    for k, (side, (place, axes)) in enumerate(zip(SIDES, doors, strict=True)):
        block = origin + (0.5 - k) * gear.block_distance * port
        upper, lower = (mouth[0], mouth[-1]) if k == 0 else (mouth[half - 1], mouth[half])
        strands += _side(side, block, place, axes, gear, [upper, lower])
        strands.append(_one_colour(f'{side}_wing_end', chain(np.array([upper, lower])), NETTING))
    return GearShape(
        moment.time,
        tuple(_in_ships_axes(strand, origin, yaw) for strand in strands),
        FROM_TRUTH,
        by_tension=False,
    )


def _from_readings(time: float, tow: TowHistory, gear: GearRecord) -> GearShape | None:
    def reading(name: str) -> float:
        series = tow.measured.get(name)
        return math.nan if series is None else series.near(time, READING_AWAY_S)

    # Ahead, to port, up, from between the blocks; turned into the ship's axes at the end.
    half_spread, half_blocks = 0.5 * reading('door_spread'), 0.5 * gear.block_distance
    strands: list[Strand] = []
    behind, ends = [], []
    for side, sign in zip(SIDES, (1.0, -1.0), strict=True):
        depth, length = reading(f'{side}_door_depth'), reading(f'{side}_length')
        astern = length**2 - depth**2 - (half_spread - half_blocks) ** 2
        if not astern > 0.0:
            continue
        place = np.array([-math.sqrt(astern), sign * half_spread, -depth])
        angles = (reading(f'{side}_{name}') for name in ('roll', 'pitch'))
        roll, pitch = (angle if math.isfinite(angle) else 0.0 for angle in angles)
        axes = Rotation.from_quat(to_quaternion(roll, pitch, 0.0)).as_matrix()
        block = np.array([0.0, sign * half_blocks, 0.0])
        strands += _side(side, block, place, axes, gear, [])
        behind.append(place)
        ends.append((side, sign, place))
    if not strands:
        return None
    depth, height, width = map(reading, ('net_depth', 'opening_height', 'opening_width'))
    height, half_width = (0.0 if not math.isfinite(x) else x for x in (height, 0.5 * width))
    if math.isfinite(depth):
        x = float(np.mean(behind, axis=0)[0]) - gear.behind_boards
        ring = [[x, s * half_width, -depth - d * height] for s, d in ((1, 0), (-1, 0), (-1, 1))]
        ring = [*ring, [x, half_width, -depth - height], ring[0]]
        strands.append(_one_colour('mouth', chain(np.array(ring)), NETTING))
        for side, sign, place in ends:
            for name, z in (('upper', -depth), ('lower', -depth - height)):
                wing = np.array([place, [x, sign * half_width, z]])
                strands.append(_one_colour(f'{side}_{name}_bridle', chain(wing), COLOURS[side]))
    return GearShape(
        time,
        tuple(_in_ships_axes(strand, np.zeros(3), 0.0) for strand in strands),
        FROM_READINGS,
        by_tension=False,
    )


def _side(
    side: str,
    block: FloatArray,
    door: FloatArray,
    axes: FloatArray,
    gear: GearRecord,
    wings: Sequence[FloatArray],
) -> list[Strand]:
    """Strands of a side: warp, door and bridles, straight."""
    colour = COLOURS[side]
    board = plate(door, axes, (gear.board.chord_m, gear.board.span_m))
    return [
        _one_colour(f'{side}_warp', chain(np.array([block, door])), colour),
        _one_colour(f'door_{side}', board, colour),
        *(
            _one_colour(f'{side}_{name}_bridle', chain(np.array([door, wing])), colour)
            for name, wing in zip(('upper', 'lower'), wings, strict=False)
        ),
    ]


def chain(points: FloatArray) -> FloatArray:
    """Return the pieces (n - 1, 2, 3) of a line through points (n, 3)."""
    return np.stack([points[:-1], points[1:]], axis=1)


def _one_colour(name: str, pieces: FloatArray, colour: str) -> Strand:
    return Strand(name, pieces, np.tile(to_rgb(colour), (len(pieces), 1)))


def _in_ships_axes(strand: Strand, origin: FloatArray, yaw: float) -> Strand:
    """Transform a strand from ``map`` to the ship's axes: astern, to port, up."""
    ahead = np.array([math.cos(yaw), math.sin(yaw), 0.0])
    basis = np.array([-ahead, [-ahead[1], ahead[0], 0.0], [0.0, 0.0, 1.0]])
    return Strand(strand.name, (strand.pieces - origin) @ basis.T, strand.colours)
