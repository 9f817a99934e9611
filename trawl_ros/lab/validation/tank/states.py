# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Measured states of a net in a flume tank."""

import csv
import math
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

from trawl_ros.core.errors import TrawlError
from trawl_ros.core.units import UNITS

TRAWL = '83-112'
"""The trawl of the states, by its name in the table."""

TUNED = ('64.0',)
"""Trial that set one number of the gear file; it never counts."""

BRIDLE, SWEEP, SHACKLE = 54.9, 27.4, 0.61
"""Lengths (m): of bridles as printed (standard ones; others follow a sweep and are as long as
it), and what lengthens the lower ones: printed spreads of doors and lower wings and bridle angles
leave 70.7 m (70.5 to 71.0) of rope on either side, for bridles, legs and 0.6 m."""

TRUNCATED = 47.95
"""Length (m) of standard bridles in rigs with short ones, of which 63.8 m of rope remain."""

LEG = 15.24
"""Legs of the doors and their extensions (m), 10 and 40 feet, which were not in the tank: the
report of the test says so, and that it worked spreads of doors out from them and the bridle
angle."""

MOST_ROWS = 10_000


@dataclass(frozen=True)
class FlumeState:
    """State as it was measured; NaN where the table has no figure.

    Attributes
    ----------
    trial
        Its number in the table.
    sweeps
        True where two bridles of 27.4 m follow a sweep of as much, not two of 54.9 m the leg.
    short
        True where the legs before them are the short ones.
    catch
        True if there was something in the codend.
    elevation
        Height (m) of the pulling points above the floor.
    pulling_points
        Distance (m) between them: of the doors, less what the legs would add on both sides.
    speed
        Of the water, m/s.
    spread, height
        Distance (m) between the upper wing tips, height (m) of the headrope above the footrope.
    tension
        Of both sides together, N.
    lower_spread, wing_height
        Distance (m) between the lower wing tips, height (m) of the upper ones above the floor.
    """

    trial: str
    sweeps: bool
    short: bool
    catch: bool
    elevation: float
    pulling_points: float
    speed: float
    spread: float
    height: float
    tension: float
    lower_spread: float = math.nan
    wing_height: float = math.nan

    @property
    def counts(self) -> bool:
        """True for the states chosen beforehand: standard bridles, normal legs, empty codend."""
        return not (self.sweeps or self.short or self.catch or self.trial in TUNED)


def read_states(path: Path) -> list[FlumeState]:
    """Read the states of one trawl.

    Raises
    ------
    TrawlError
        If the file is no such table, or has none of them.
    """
    try:
        with path.open(newline='', encoding='utf-8') as file:
            rows = [
                _state(row)
                for row in islice(csv.DictReader(file), MOST_ROWS)
                if row['trawl'] == TRAWL
            ]
    except (OSError, ValueError, KeyError, TypeError) as reason:
        raise TrawlError(
            f'{path}: cannot be read, expected the table of flume-tank states with columns trial, '
            f'trawl, bridles, … ({reason})'
        ) from None
    if not rows:
        raise TrawlError(f'{path}: found no state of {TRAWL} in column trawl, expected some')
    return rows


def _state(row: dict[str, str]) -> FlumeState:
    angle = math.radians(float(row['bridle_angle_deg']))
    return FlumeState(
        trial=row['trial'],
        sweeps=row['bridles'] != 'standard',
        short=row['bridle_length'] == 'short',
        catch=row['catch'] != 'empty',
        elevation=1e-3 * float(row['pulling_point_elevation_mm']),
        pulling_points=float(row['door_spread_m']) - 2.0 * LEG * math.sin(angle),
        speed=UNITS['kn'].size * float(row['towing_speed_kn']),
        spread=_number(row['spread_u_wing_m']),
        height=_number(row['opening_headline_m']),
        tension=UNITS['tf'].size * _number(row['bridle_tension_total_t']),
        lower_spread=_number(row['spread_l_wing_m']),
        wing_height=_number(row['upper_wingend_height_m']),
    )


def _number(text: str) -> float:
    return float(text) if text else math.nan
