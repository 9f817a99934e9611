"""`trawl_sonar_node`: the trawl sonar's image, what is read off it, and its housing's sensors."""

from collections.abc import Sequence
from typing import Any, ClassVar

from trawl_ros.instruments.errors.faults import Faulty
from trawl_ros.instruments.trawl_sonar import SonarInstruments
from trawl_ros.messages.truth_from_messages import net_truth, schools_truth, seabed_truth
from trawl_ros.nodes.instrument_node import InstrumentNode, Setup
from trawl_ros.nodes.runtime.run import run
from trawl_ros.records.partial_truth import partial_truth
from trawl_ros.records.samples import Sample

OPENING, POSE, SECTION = 'truth/net/opening', 'truth/sonar/pose', 'truth/sonar/section'
SCHOOLS, SEABED = 'truth/schools', 'truth/seabed'


class TrawlSonarNode(InstrumentNode):
    """Reports image, scan and points per sweep, the openings read off, pressure and bottom."""

    NAME: ClassVar = 'trawl_sonar_node'

    def set_up(self, setup: Setup) -> Sequence[Faulty]:
        """Make the instruments and give all of them."""
        self._instruments = SonarInstruments(
            setup.parameters.sonar, setup.draws, surroundings=setup.surroundings
        )
        return self._instruments.instruments

    def observe(self, stamp: int, messages: dict[str, Any]) -> Sequence[Sample]:
        """Give the samples due at a stamp (ns)."""
        truth = partial_truth(
            stamp,
            net=net_truth(messages[OPENING], messages[POSE], section=messages[SECTION]),
            schools=schools_truth(messages[SCHOOLS]),
            seabed=seabed_truth(messages[SEABED]),
        )
        return self._instruments.observe(truth)


def main(args: Sequence[str] | None = None) -> int:
    """Run the node."""
    return run(TrawlSonarNode, args)
