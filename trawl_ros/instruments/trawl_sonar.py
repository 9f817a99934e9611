"""The trawl sonar on the headrope: its pressure sensor, and the openings read off it."""

from trawl_ros.instruments.distance import RangeInstrument
from trawl_ros.instruments.instrument import Draws
from trawl_ros.instruments.parameters import PressureParameters, RangeParameters, SonarParameters
from trawl_ros.instruments.pressure import PressureInstrument
from trawl_ros.instruments.samples import Sample
from trawl_ros.instruments.surroundings import PressureAt, Surroundings
from trawl_ros.simulation.truth import Truth


class SonarPressure(PressureInstrument):
    """Pressure at the headrope's centre. Sees the depth there (m)."""

    def __init__(
        self, parameters: PressureParameters, pressure_at: PressureAt, draws: Draws
    ) -> None:
        super().__init__('sonar/pressure', 'sonar', parameters, pressure_at, draws)


class SonarOpening(RangeInstrument):
    """An opening of the net as the sonar's operator reads it off, once per sweep.

    Sees the true opening (m): the reading is not made from an image of the echoes.
    ``what`` is 'opening_height' or 'opening_width'.
    """

    def __init__(self, what: str, parameters: RangeParameters, draws: Draws) -> None:
        super().__init__(f'sonar/{what}', what, parameters, draws)


class SonarInstruments:
    """All that the trawl sonar reports."""

    def __init__(
        self, parameters: SonarParameters, draws: Draws, *, surroundings: Surroundings
    ) -> None:
        self.pressure = SonarPressure(parameters.pressure, surroundings.pressure_at, draws)
        self.height = SonarOpening('opening_height', parameters.opening_height, draws)
        self.width = SonarOpening('opening_width', parameters.opening_width, draws)
        self.instruments = (self.pressure, self.height, self.width)

    def observe(self, truth: Truth) -> list[Sample]:
        """Give the samples that are due."""
        net, stamp = truth.net, truth.stamp
        samples: list[Sample] = []
        samples += self.pressure.observe(net.headrope_depth, stamp)
        samples += self.height.observe(net.vertical_opening, stamp)
        samples += self.width.observe(net.horizontal_opening, stamp)
        return samples
