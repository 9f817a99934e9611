# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""`door_sensor_node`: depth, attitude and spread of the otter boards."""

from collections.abc import Sequence
from typing import Any, ClassVar

from trawl_ros.instruments.doors import DoorInstruments
from trawl_ros.instruments.errors.faults import Faulty
from trawl_ros.messages.truth_from_messages import door_truth
from trawl_ros.nodes.instrument_node import InstrumentNode, Setup
from trawl_ros.nodes.runtime.run import run
from trawl_ros.nodes.runtime.transforms import send_mounts
from trawl_ros.records.frames import DOOR_MOUNTS
from trawl_ros.records.partial_truth import partial_truth
from trawl_ros.records.samples import Sample

PORT, STARBOARD = 'truth/door/port/odom', 'truth/door/starboard/odom'


class DoorSensorNode(InstrumentNode):
    """Reports ``door/{port,starboard}/{pressure,attitude}`` and ``door/spread``."""

    NAME: ClassVar = 'door_sensor_node'

    def set_up(self, setup: Setup) -> Sequence[Faulty]:
        """Make the instruments and give all of them."""
        send_mounts(self, DOOR_MOUNTS)
        self._instruments = DoorInstruments(
            setup.parameters.door, setup.draws, surroundings=setup.surroundings
        )
        return self._instruments.instruments

    def observe(self, stamp: int, messages: dict[str, Any]) -> Sequence[Sample]:
        """Give the samples due at a stamp (ns)."""
        port, starboard = (door_truth(topic, messages[topic]) for topic in (PORT, STARBOARD))
        return self._instruments.observe(partial_truth(stamp, doors=(port, starboard)))


def main(args: Sequence[str] | None = None) -> int:
    """Run the node."""
    return run(DoorSensorNode, args)
