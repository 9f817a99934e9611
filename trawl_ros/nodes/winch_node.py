# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""`winch_node`: counters, pay-out speeds and load cells of the winches."""

from collections.abc import Sequence
from typing import Any, ClassVar

from trawl_ros.instruments.errors.faults import Faulty
from trawl_ros.instruments.winch import WinchInstruments
from trawl_ros.messages.truth_from_messages import winch_truth
from trawl_ros.nodes.instrument_node import InstrumentNode, Setup
from trawl_ros.nodes.runtime.run import run
from trawl_ros.records.partial_truth import partial_truth
from trawl_ros.records.samples import Sample

WINCH = 'truth/winch'


class WinchNode(InstrumentNode):
    """Reports ``winch/joint_states``."""

    NAME: ClassVar = 'winch_node'

    def set_up(self, setup: Setup) -> Sequence[Faulty]:
        """Make the instruments and give all of them."""
        self._instruments = WinchInstruments(setup.parameters.winch, setup.draws)
        return self._instruments.instruments

    def observe(self, stamp: int, messages: dict[str, Any]) -> Sequence[Sample]:
        """Give the samples due at a stamp (ns)."""
        winches = winch_truth(WINCH, messages[WINCH])
        return self._instruments.observe(partial_truth(stamp, winches=winches))


def main(args: Sequence[str] | None = None) -> int:
    """Run the node."""
    return run(WinchNode, args)
