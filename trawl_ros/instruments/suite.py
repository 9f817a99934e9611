# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Suite of all instruments of a ship, in four groups; each group is one node of the graph."""

from collections.abc import Sequence

from trawl_ros.instruments.doors import DoorInstruments
from trawl_ros.instruments.errors.fault_plan import FaultPlan, PlannedFault
from trawl_ros.instruments.errors.faults import FaultPanel, Faulty
from trawl_ros.instruments.errors.instrument import SeedPlan
from trawl_ros.instruments.observing import ObservingInstruments
from trawl_ros.instruments.parameters import InstrumentParameters
from trawl_ros.instruments.trawl_sonar import SonarInstruments
from trawl_ros.instruments.vessel import VesselInstruments
from trawl_ros.instruments.winch import WinchInstruments
from trawl_ros.records.samples import Sample
from trawl_ros.records.surroundings import Surroundings
from trawl_ros.records.truth import Truth


class InstrumentSuite:
    """Suite of all instruments; a group alone gives the same samples.

    Parameters
    ----------
    parameters
        Parameters from `load_instruments`.
    surroundings
        Water around the sensors.
    draws
        Seed and changes of state.
    faults
        Planned faults.

    Attributes
    ----------
    panel : FaultPanel
        Switches of faults.

    Examples
    --------
    >>> import trawl_ros
    >>> from trawl_ros.instruments.errors.instrument import SeedPlan
    >>> from trawl_ros.records.surroundings import Surroundings
    >>> suite = trawl_ros.InstrumentSuite(
    ...     trawl_ros.load_instruments('worn'),
    ...     surroundings=Surroundings(pressure_at=lambda depth: 101_325.0 + 10_052.0 * depth),
    ...     draws=SeedPlan(seed=3),
    ... )
    >>> samples = suite.observe(next(trawl_ros.simulate('tow.yaml')))
    >>> type(samples[0]).__name__
    'WinchSample'
    """

    def __init__(
        self,
        parameters: InstrumentParameters,
        *,
        surroundings: Surroundings,
        draws: SeedPlan,
        faults: Sequence[PlannedFault] = (),
    ) -> None:
        self.winch = WinchInstruments(parameters.winch, draws)
        self.door = DoorInstruments(parameters.door, draws, surroundings=surroundings)
        self.sonar = SonarInstruments(parameters.sonar, draws, surroundings=surroundings)
        self.vessel = VesselInstruments(parameters.vessel, draws, surroundings=surroundings)

        self.observing = ObservingInstruments(parameters, draws)

        groups = (self.winch, self.door, self.sonar, self.vessel, self.observing)
        sensors: list[Faulty] = []
        for group in groups:
            sensors += group.instruments
        self.panel = FaultPanel(sensors)
        self._plan = FaultPlan(faults, self.panel)

    def observe(self, truth: Truth) -> list[Sample]:
        """Return the samples that are due at one instant, always in the same order."""
        self._plan.follow(truth.stamp)
        groups = (self.winch, self.door, self.sonar, self.vessel)
        samples = [sample for group in groups for sample in group.observe(truth)]
        return samples + self.observing.observe(truth.observables, truth.stamp)
