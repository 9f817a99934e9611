"""A tow that obeys commands as they come, beside `Trial`, which follows a scenario's."""

from dataclasses import replace
from typing import Protocol

from trawl_ros.errors import ScenarioError
from trawl_ros.model.gear_model import GearModel
from trawl_ros.scenario.records import MAX_TRUTH_HZ
from trawl_ros.simulation.simulation import NANOSECONDS, Command, Simulation
from trawl_ros.simulation.truth import Truth
from trawl_ros.solver.stepper import StepFailed


class Tow(Protocol):
    """What `sim_node` tows with."""

    simulation: Simulation

    @property
    def time_s(self) -> float:
        """Simulated time since the start, s."""

    def step(self) -> Truth | None:
        """Tow on for one period of the truth; the start itself at first, None after the end."""

    def reset(self) -> None:
        """Back to the start."""


class CommandedTow:
    """Tows on without end, towards whatever was commanded last.

    Parameters
    ----------
    model
        The plant.
    start
        The steady tow it starts from.
    heading
        First heading, ENU yaw, rad.
    steps_per_truth
        Time steps of 0.1 s from one truth to the next.

    Raises
    ------
    NoSteadyState
        If the start is none.
    """

    def __init__(
        self, model: GearModel, start: Command, *, heading: float, steps_per_truth: int = 1
    ) -> None:
        self.simulation = Simulation(model, start, heading=heading, period=1.0 / MAX_TRUTH_HZ)
        self._steps = steps_per_truth
        self._started = False

    @property
    def time_s(self) -> float:
        """Simulated time since the start, s."""
        return self.simulation.now.stamp / NANOSECONDS

    def command_winches(self, port: float | None, starboard: float | None) -> None:
        """Ask for warp lengths (m); None leaves that winch as it is."""
        wanted = self.simulation.command
        self.simulation.command = replace(
            wanted,
            port_length=wanted.port_length if port is None else port,
            starboard_length=wanted.starboard_length if starboard is None else starboard,
        )

    def command_vessel(self, speed: float, turn_rate: float) -> None:
        """Ask for a speed through the water (m/s) and a rate of turn (rad/s, to port)."""
        self.simulation.command = replace(self.simulation.command, speed=speed, turn_rate=turn_rate)

    def reset(self) -> None:
        """Back to the start."""
        self.simulation.reset()
        self._started = False

    def step(self) -> Truth:
        """Tow on for one period of the truth; the start itself at first.

        Raises
        ------
        ScenarioError
            If the gear is moved so violently that its motion cannot be computed.
        """
        if self._started:
            for _ in range(self._steps):
                try:
                    self.simulation.advance()
                except StepFailed as reason:
                    raise ScenarioError(
                        f'the motion of the gear cannot be computed beyond {self.time_s:.1f} s '
                        f'({reason}); expected milder commands'
                    ) from reason
        self._started = True
        return self.simulation.truth()
