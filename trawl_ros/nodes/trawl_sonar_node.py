# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""`trawl_sonar_node`: the trawl sonar's image, what is read off it, and its housing's sensors."""

from collections.abc import Sequence
from typing import Any, ClassVar

from trawl_ros.core.time import SECOND
from trawl_ros.instruments.errors.faults import Faulty
from trawl_ros.instruments.trawl_sonar import SonarInstruments
from trawl_ros.messages.truth_from_messages import net_truth, schools_truth, seabed_truth
from trawl_ros.nodes.instrument_node import InstrumentNode, Setup
from trawl_ros.nodes.runtime.parameters import Text
from trawl_ros.nodes.runtime.run import run
from trawl_ros.nodes.runtime.transforms import send_mounts
from trawl_ros.records.frames import WIDTH_MOUNT
from trawl_ros.records.partial_truth import partial_truth
from trawl_ros.records.registry import changed
from trawl_ros.records.samples import PICTURES, Sample, SonarScanSample

OPENING, POSE, SECTION = 'truth/net/opening', 'truth/sonar/pose', 'truth/sonar/section'
SCHOOLS, SEABED = 'truth/schools', 'truth/seabed'
OF_A_SWEEP = (*PICTURES, 'sonar/opening_height', 'sonar/opening_width')


class TrawlSonarNode(InstrumentNode):
    """Reports image, scan and points per sweep, the openings read off, pressure and bottom."""

    NAME: ClassVar = 'trawl_sonar_node'
    SPECS: ClassVar = (
        *InstrumentNode.SPECS,
        Text('sweep_stamp', 'start', 'Whether image, scan, points and openings of a sweep are '
             'stamped at its first ping or at its end, when they are sent: tf2 holds transforms '
             'for 10 s.', choices=('start', 'end')),
    )  # fmt: skip

    def set_up(self, setup: Setup) -> Sequence[Faulty]:
        """Make the instruments and give all of them."""
        send_mounts(self, [WIDTH_MOUNT])
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
        samples = self._instruments.observe(truth)
        if self.parameters['sweep_stamp'] == 'start':
            return samples
        return [self._at_end(one) if one.topic in OF_A_SWEEP else one for one in samples]

    def _at_end(self, sample: Sample) -> Sample:
        stamp = sample.stamp + round(self._instruments.sonar.sweep_s * SECOND)
        if isinstance(sample, SonarScanSample):
            return changed(sample, stamp=stamp, stamped_at_end=True)
        return changed(sample, stamp=stamp)


def main(args: Sequence[str] | None = None) -> int:
    """Run the node."""
    return run(TrawlSonarNode, args)
