# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""`vessel_node`: the ship's speed log, GPS, compass, echo sounder and fish sonar."""

from collections.abc import Sequence
from typing import Any, ClassVar

from trawl_ros.instruments.errors.faults import Faulty
from trawl_ros.instruments.vessel import VesselInstruments
from trawl_ros.messages.truth_from_messages import schools_truth, seabed_truth, vessel_truth
from trawl_ros.nodes.instrument_node import InstrumentNode, Setup
from trawl_ros.nodes.runtime.datum import datum_specs
from trawl_ros.nodes.runtime.run import run
from trawl_ros.nodes.runtime.transforms import send_mounts
from trawl_ros.records.frames import echo_sounder_mount
from trawl_ros.records.partial_truth import partial_truth
from trawl_ros.records.samples import Sample

ODOMETRY, THROUGH_WATER = 'truth/vessel/odom', 'truth/vessel/velocity_water'
SCHOOLS, SEABED = 'truth/schools', 'truth/seabed'


class VesselNode(InstrumentNode):
    """Reports velocity, heading, position, echo sounder and fish sonar of the ship.

    Topics: ``vessel/{velocity_water,velocity_ground,heading,fix}``,
    ``vessel/echo_sounder/{depth,school}`` and ``vessel/fish_sonar``.
    """

    NAME: ClassVar = 'vessel_node'

    def set_up(self, setup: Setup) -> Sequence[Faulty]:
        """Make the instruments and give all of them."""
        record = setup.parameters.vessel
        datum = self.declare_specs(datum_specs(record))
        send_mounts(self, [echo_sounder_mount(record.draught_m)])
        placed = {'datum_lat_deg': datum['datum_lat'], 'datum_lon_deg': datum['datum_lon']}
        self._instruments = VesselInstruments(
            record.model_copy(update=placed), setup.draws, surroundings=setup.surroundings
        )
        return self._instruments.instruments

    def observe(self, stamp: int, messages: dict[str, Any]) -> Sequence[Sample]:
        """Give the samples due at a stamp (ns)."""
        vessel = vessel_truth(messages[ODOMETRY], messages[THROUGH_WATER])
        return self._instruments.observe(
            partial_truth(
                stamp,
                vessel=vessel,
                schools=schools_truth(messages[SCHOOLS]),
                seabed=seabed_truth(messages[SEABED]),
            )
        )


def main(args: Sequence[str] | None = None) -> int:
    """Run the node."""
    return run(VesselNode, args)
