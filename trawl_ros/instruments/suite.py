"""All instruments of a ship, in the four groups that are nodes in the graph."""

from trawl_ros.instruments.doors import DoorInstruments
from trawl_ros.instruments.instrument import Draws
from trawl_ros.instruments.parameters import InstrumentParameters
from trawl_ros.instruments.pressure import PressureAt
from trawl_ros.instruments.samples import Sample
from trawl_ros.instruments.trawl_sonar import SonarInstruments
from trawl_ros.instruments.vessel import VesselInstruments
from trawl_ros.instruments.winch import WinchInstruments
from trawl_ros.simulation.truth import Truth


class InstrumentSuite:
    """Every instrument; a group on its own gives the very same samples.

    Parameters
    ----------
    parameters
        From `load_instruments`.
    pressure_at
        Absolute pressure (Pa) at a depth (m).
    draws
        Seed and changes of state.
    """

    def __init__(
        self, parameters: InstrumentParameters, *, pressure_at: PressureAt, draws: Draws
    ) -> None:
        self.winch = WinchInstruments(parameters.winch, draws)
        self.door = DoorInstruments(parameters.door, draws, pressure_at=pressure_at)
        self.sonar = SonarInstruments(parameters.sonar, draws, pressure_at=pressure_at)
        self.vessel = VesselInstruments(parameters.vessel, draws)

    def observe(self, truth: Truth) -> list[Sample]:
        """Give the samples that are due at one instant, always in the same order."""
        groups = (self.winch, self.door, self.sonar, self.vessel)
        return [sample for group in groups for sample in group.observe(truth)]
