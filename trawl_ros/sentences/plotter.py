# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Sentences to a chart plotter: where doors and net are, as TTM, TPR and TPT.

TTM is that of NMEA 0183. TPR and TPT have the form of the manuals of Simrad CS90 and of Marport
Scala V7: they begin with @ and have no checksum.

The positions are those of straight warps: a door is as far astern as warp, depth and half the
spread leave. A warp that hangs through is a little nearer. The net is behind the middle of the
doors.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import UTC, datetime

from trawl_ros.core.time import SECOND
from trawl_ros.records.fields import WaterColumn, fields_of_sample
from trawl_ros.records.samples import Sample
from trawl_ros.sentences.framing import framed

TOPICS = (
    'winch/joint_states', 'door/spread', 'door/port/pressure', 'door/starboard/pressure',
    'door/port/slant_range', 'door/starboard/slant_range', 'sonar/pressure', 'vessel/heading',
)  # fmt: skip
"""Topics of the readings that positions are computed from."""

MAX_AGE_S = 120.0
"""Oldest reading that is used, s: acoustic sensors are silent for that long."""

TARGETS = {'port': ('01', 'DOOR P'), 'starboard': ('02', 'DOOR S'), 'net': ('03', 'NET')}
"""Numbers and names of the targets in TTM."""


@dataclass(frozen=True)
class Place:
    """Horizontal range (m) from the ship, bearing from her bow (rad, clockwise), and depth (m)."""

    horizontal_range: float
    bearing: float
    depth: float


def trawl_places(readings: Mapping[str, float], net_behind_m: float) -> dict[str, Place]:
    """Return the places of 'port' and 'starboard' door and of the 'net', as far as known.

    Parameters
    ----------
    readings
        Values (m) by topic and field, such as ``door/spread distance``. A slant range is taken in
        place of the warp length.
    net_behind_m
        Length of bridles and sweeps between doors and headrope, m.
    """
    half = 0.5 * readings.get('door/spread distance', math.nan)
    found, astern = {}, []
    for side, outward in (('port', -1.0), ('starboard', 1.0)):
        depth = readings.get(f'door/{side}/pressure depth', math.nan)
        paid_out = readings.get(f'winch/joint_states {side}_length', math.nan)
        slant = readings.get(f'door/{side}/slant_range distance', paid_out)
        square = slant**2 - depth**2 - half**2
        if square > 0.0:  # false for NaN
            astern.append(math.sqrt(square))
            found[side] = _place(-astern[-1], outward * half, depth)
    net_depth = readings.get('sonar/pressure depth', math.nan)
    if len(astern) == 2 and math.isfinite(net_depth):
        below = net_depth - 0.5 * (found['port'].depth + found['starboard'].depth)
        behind = math.sqrt(max(net_behind_m**2 - below**2 - half**2, 0.0))
        found['net'] = _place(-0.5 * sum(astern) - behind, 0.0, net_depth)
    return found


def _place(ahead: float, to_starboard: float, depth: float) -> Place:
    bearing = math.atan2(to_starboard, ahead) % (2 * math.pi)
    return Place(math.hypot(ahead, to_starboard), bearing, depth)


class PlotterWriter:
    """Writer of positions, from the newest reading of each sensor.

    Parameters
    ----------
    water
        By which pressures become depths.
    net_behind_m
        Length of bridles and sweeps, m.
    """

    def __init__(self, water: WaterColumn, net_behind_m: float) -> None:
        self._water, self._net_behind_m = water, net_behind_m
        self._newest: dict[str, tuple[int, float]] = {}

    def write(self, sample: Sample) -> list[str]:
        """Take a sample; one of the winches makes sentences, without their ends."""
        taken = fields_of_sample(sample, self._water)
        if taken is None or taken[0] not in TOPICS:
            return []
        for name, value in taken[1].items():
            if math.isfinite(value):
                self._newest[f'{taken[0]} {name}'] = sample.stamp, value
        return self._sentences(sample.stamp) if taken[0] == TOPICS[0] else []

    def _sentences(self, stamp: int) -> list[str]:
        readings = {
            name: value
            for name, (read, value) in self._newest.items()
            if abs(stamp - read) <= MAX_AGE_S * SECOND
        }
        places = trawl_places(readings, self._net_behind_m)
        heading = readings.get('vessel/heading compass_heading')
        clock = datetime.fromtimestamp(stamp / SECOND, UTC).strftime('%H%M%S.00')
        texts: list[str] = []
        for name, place in places.items():
            number, said = TARGETS[name]
            miles = place.horizontal_range / 1852.0
            relative = math.degrees(place.bearing)
            body = f'IITTM,{number},{miles:.3f},{relative:.1f},R,,,,,,N,{said},T,,{clock},A'
            texts.append(framed('$', body, checksum=True))
        if (net := places.get('net')) is not None:
            bearings = {'TPR': net.bearing}
            if heading is not None:
                bearings['TPT'] = (net.bearing + heading) % (2 * math.pi)
            texts += [
                f'@II{kind},{net.horizontal_range:.0f},M,{math.degrees(bearing) % 360:.0f},P,'
                f'{net.depth:.1f},M'
                for kind, bearing in bearings.items()
            ]
        return texts
