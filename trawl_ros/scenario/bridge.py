# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Bridge of a trial: autopilot and autotrawl, with their instruments."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from trawl_ros.control.autopilot import Autopilot, AutopilotSettings
from trawl_ros.control.autotrawl import Autotrawl
from trawl_ros.control.winch_controller import WinchController
from trawl_ros.core.geodesy import Datum
from trawl_ros.instruments.errors.fault_plan import FaultPlan
from trawl_ros.instruments.errors.faults import FaultPanel
from trawl_ros.instruments.vessel import VesselInstruments
from trawl_ros.instruments.winch import WinchInstruments
from trawl_ros.records.samples import (
    FixSample,
    HeadingSample,
    SchoolsSample,
    VelocitySample,
    WinchSample,
)
from trawl_ros.records.towing_limits import LIMITS
from trawl_ros.records.truth import Truth
from trawl_ros.scenario.driving import AutotrawlRecord, SteerRecord
from trawl_ros.scenario.scenario import Scenario
from trawl_ros.simulation.command import Command


class Bridge:
    """Bridge, which replaces planned commands of a scenario by those of its controllers.

    Its instruments use the same random numbers as the instrument nodes, so the controllers receive
    the same readings, including faults.

    Parameters
    ----------
    scenario
        Scenario with steps of autopilot and autotrawl.
    winches
        Makes a controller in place of that of the steps from the lengths (port, starboard), m.
    """

    def __init__(
        self,
        scenario: Scenario,
        winches: Callable[[tuple[float, float]], WinchController] | None = None,
    ) -> None:
        self._scenario = scenario
        self._winches = winches
        made = scenario.instruments
        self._winch = WinchInstruments(made.winch, scenario.draws)
        self._vessel = VesselInstruments(
            made.vessel, scenario.draws, surroundings=scenario.surroundings
        )
        sensors = (*self._winch.instruments, *self._vessel.instruments)
        self._plan = FaultPlan(scenario.faults, FaultPanel(sensors))
        self._datum = Datum(made.vessel.datum_lat_deg, made.vessel.datum_lon_deg)
        self._autopilot = Autopilot(AutopilotSettings(), self._datum)
        self._autotrawl: WinchController | None = None
        self._steer: SteerRecord | None = None
        self._work: AutotrawlRecord | None = None
        self._given = scenario.start
        self._turn_rate = 0.0

    def observe(self, truth: Truth) -> None:
        """Observe the truth with the instruments, and pass their samples to the controllers."""
        self._plan.follow(truth.stamp)
        if self._scenario.steered:
            self._observe_ship(truth)
        if self._scenario.autotrawled:
            self._observe_winches(truth)

    def command(self, time: float) -> Command:
        """Return the command to ship and winches at a time (s since the start)."""
        planned = self._scenario.commands_at(time)
        driving = self._scenario.driving_at(time)
        if driving.steer is not self._steer:
            self._begin_to_steer(driving.steer)
        if driving.autotrawl is not self._work:
            self._begin_to_work(driving.autotrawl)
        if self._steer is not None:
            planned = replace(planned, turn_rate=self._turn_rate)
        if self._autotrawl is not None:
            self._autotrawl.set_lengths(planned.port_length, planned.starboard_length)
            port, starboard = np.clip(self._autotrawl.wanted, *LIMITS.warp_m).tolist()
            planned = replace(planned, port_length=port, starboard_length=starboard)
        self._given = planned
        return planned

    def _begin_to_steer(self, record: SteerRecord | None) -> None:
        self._steer = record
        self._turn_rate = 0.0
        if record is not None:
            ship = self._scenario.plant.ship
            self._autopilot.settings = record.settings(
                math.radians(ship.max_turn_acceleration_deg_s2)
            )
            self._autopilot.steer(record.target(self._datum))

    def _begin_to_work(self, record: AutotrawlRecord | None) -> None:
        self._work = record
        winch = self._scenario.plant.winch
        settings = None
        if record is not None:
            settings = record.settings(winch.max_speed_m_s, winch.max_acceleration_m_s2)
        if settings is None:
            self._autotrawl = None
        elif self._autotrawl is None:
            lengths = self._given.port_length, self._given.starboard_length
            own = Autotrawl(settings, lengths)
            self._autotrawl = own if self._winches is None else self._winches(lengths)
        elif isinstance(self._autotrawl, Autotrawl) and self._winches is None:
            self._autotrawl.change(settings)

    def _observe_ship(self, truth: Truth) -> None:
        for sample in self._vessel.observe(truth):
            if isinstance(sample, HeadingSample | FixSample | VelocitySample | SchoolsSample):
                self._autopilot.take(sample)
        if self._steer is not None:
            self._turn_rate = self._autopilot.turn_rate(truth.stamp)

    def _observe_winches(self, truth: Truth) -> None:
        for sample in self._winch.observe(truth):
            if isinstance(sample, WinchSample) and self._autotrawl is not None:
                self._autotrawl.update(sample)
