# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Records of the controllers in a scenario step: autopilot and autotrawl."""

import math
from itertools import pairwise
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, model_validator

from trawl_ros.control.autopilot import (
    AutopilotSettings,
    FollowTrack,
    HoldCourse,
    HoldHeading,
    Target,
    ToSchool,
)
from trawl_ros.control.autotrawl_records import AutotrawlSettings
from trawl_ros.core.geodesy import Datum, to_east_north
from trawl_ros.core.schema import Record

Degrees = Annotated[float, Field(ge=-360, le=360)]
Metres = Annotated[float, Field(ge=-500_000, le=500_000)]
Latitude = Annotated[float, Field(ge=-89, le=89)]
Longitude = Annotated[float, Field(ge=-180, le=180)]
Gain = Annotated[float, Field(ge=0, le=5)]

_PILOT = AutopilotSettings()
_TRAWL = AutotrawlSettings()


class SteerRecord(Record):
    """Target and settings of the autopilot; exactly one of the first five keys is required.

    ``heading_deg`` by compass and ``course_deg`` over ground are ENU yaw (0 = east, to port
    positive). A track leads to its first waypoint and along the legs to the last: ``track_m`` in
    east and north of ``map``, ``track_deg`` in latitude and longitude. ``to_school`` steers to the
    nearest school that the fish sonar detects ahead.
    """

    heading_deg: Degrees | None = None
    course_deg: Degrees | None = None
    track_m: (
        Annotated[tuple[tuple[Metres, Metres], ...], Field(min_length=1, max_length=1000)] | None
    ) = None
    track_deg: (
        Annotated[tuple[tuple[Latitude, Longitude], ...], Field(min_length=1, max_length=1000)]
        | None
    ) = None
    to_school: Literal[True] | None = None
    max_turn_deg_s: Annotated[float, Field(ge=0.01, le=3)] = math.degrees(_PILOT.max_turn)
    look_ahead_m: Annotated[float, Field(ge=20, le=5000)] = _PILOT.look_ahead

    @model_validator(mode='after')
    def _one_target(self) -> 'SteerRecord':
        names = ('heading_deg', 'course_deg', 'track_m', 'track_deg', 'to_school')
        given = [name for name in names if getattr(self, name) is not None]
        if len(given) != 1:
            named = ' and '.join(given) or 'none'
            raise ValueError(f'found {named}, expected one of {", ".join(names)}')
        return self

    @model_validator(mode='after')
    def _waypoints_differ(self) -> 'SteerRecord':
        for name in ('track_m', 'track_deg'):
            for number, (waypoint, next_one) in enumerate(pairwise(getattr(self, name) or ())):
                if waypoint == next_one:
                    raise ValueError(
                        f'{name}: found waypoint {list(waypoint)} twice in a row (numbers {number} '
                        f'and {number + 1}), expected different waypoints'
                    )
        return self

    def target(self, datum: Datum) -> Target:
        """Return the autopilot's target; ``datum`` is the origin of ``map``."""
        if self.heading_deg is not None:
            return HoldHeading(math.radians(self.heading_deg))
        if self.course_deg is not None:
            return HoldCourse(math.radians(self.course_deg))
        if self.track_m is not None:
            return FollowTrack(np.array(self.track_m))
        if self.track_deg is not None:
            latitudes, longitudes = np.array(self.track_deg).T
            return FollowTrack(np.column_stack(to_east_north(latitudes, longitudes, datum)))
        return ToSchool()

    def settings(self, turn_acceleration: float) -> AutopilotSettings:
        """Return the autopilot's settings; ``turn_acceleration`` is the ship's, rad/s²."""
        return AutopilotSettings(
            max_turn=math.radians(self.max_turn_deg_s),
            turn_acceleration=turn_acceleration,
            look_ahead=self.look_ahead_m,
        )


class AutotrawlRecord(Record):
    """Settings of the autotrawl; with ``off`` the winches go to the lengths of the steps.

    ``lengths`` holds the steps' warp lengths by the counters. ``tension`` holds both warps at equal
    tension and gives way to peaks above ``tension_kn`` (by default the mean of the last minutes),
    while the mean of both counters stays at the steps' lengths.
    """

    mode: Literal['lengths', 'tension', 'off']
    tension_kn: Annotated[float, Field(gt=0, le=2000)] | None = None
    balance_gain_m_s: Gain = _TRAWL.balance_gain
    give_gain_m_s: Gain = _TRAWL.give_gain
    haul_gain_m_s: Gain = _TRAWL.haul_gain
    max_give_m: Annotated[float, Field(ge=0, le=50)] = _TRAWL.max_give_m
    max_difference_percent: Annotated[float, Field(ge=0, le=10)] = 100 * _TRAWL.max_difference

    @model_validator(mode='after')
    def _tension_where_it_is_held(self) -> 'AutotrawlRecord':
        if self.tension_kn is not None and self.mode != 'tension':
            raise ValueError(
                f"tension_kn: found in mode '{self.mode}', expected only in mode 'tension'"
            )
        return self

    def settings(self, max_speed: float, max_acceleration: float) -> AutotrawlSettings | None:
        """Return the settings with the winches' limits (m/s, m/s²); None for off."""
        if self.mode == 'off':
            return None
        return AutotrawlSettings(
            mode=self.mode,
            tension=math.nan if self.tension_kn is None else 1e3 * self.tension_kn,
            balance_gain=self.balance_gain_m_s,
            give_gain=self.give_gain_m_s,
            haul_gain=self.haul_gain_m_s,
            max_give_m=self.max_give_m,
            max_difference=0.01 * self.max_difference_percent,
            max_speed=max_speed,
            max_acceleration=max_acceleration,
        )


NOBODY = AutotrawlRecord(mode='off')
