"""`trawl_sonar_node`: depth of the headrope and the openings that its sonar shows."""

from collections.abc import Sequence
from typing import Any, ClassVar

from trawl_ros.instruments.faults import Faulty
from trawl_ros.instruments.samples import Sample
from trawl_ros.instruments.trawl_sonar import SonarInstruments
from trawl_ros.messages.from_messages import net_truth
from trawl_ros.nodes.instrument_node import InstrumentNode, Setup
from trawl_ros.nodes.partial_truth import partial_truth
from trawl_ros.nodes.runtime import run

OPENING, POSE = 'truth/net/opening', 'truth/sonar/pose'


class TrawlSonarNode(InstrumentNode):
    """Reports ``sonar/pressure``, ``sonar/opening_height`` and ``sonar/opening_width``."""

    TRUTH: ClassVar = (OPENING, POSE)
    SAMPLES: ClassVar = ('sonar/pressure', 'sonar/opening_height', 'sonar/opening_width')

    def __init__(self, **kwargs: Any) -> None:
        super().__init__('trawl_sonar_node', **kwargs)

    def set_up(self, setup: Setup) -> Sequence[Faulty]:
        """Make the instruments and give all of them."""
        self._instruments = SonarInstruments(
            setup.parameters.sonar, setup.draws, surroundings=setup.surroundings
        )
        return self._instruments.instruments

    def observe(self, stamp: int, messages: dict[str, Any]) -> Sequence[Sample]:
        """Give the samples due at a stamp (ns)."""
        net = net_truth(messages[OPENING], messages[POSE])
        return self._instruments.observe(partial_truth(stamp, net=net))


def main(args: Sequence[str] | None = None) -> int:
    """Run the node."""
    return run(TrawlSonarNode, args)
