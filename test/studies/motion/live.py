"""Live chain: identification and watch beside one another, on a bag in motion in real time."""

from collections.abc import Mapping
from pathlib import Path

from studies.live_nodes import BAG, LiveNodes, delay_row, live_nodes, share_row
from trawl_ros.core.progress import OnProgress
from trawl_ros.lab.report.measured import MeasuredValue
from trawl_ros.lab.running.processes import Value

BEFORE_S = 1500.0
"""Beginning of the bag that is played as fast as the nodes follow, so that all of a tow so far is
learned from and watched when real time begins."""

NODES: Mapping[str, Mapping[str, Value]] = {
    'identification_node': {},
    'discrepancy_node': {'watch': True},
}
"""Nodes of the chain with their parameters, of the gear as it ships."""

MOST_OF_CORE, LATEST_S = 15.0, 5.0


def live_chain(seconds: float, logs: Path, on_progress: OnProgress) -> LiveNodes:
    """Play the sample trial to both nodes, from `BEFORE_S` on in real time (`live_nodes`)."""
    return live_nodes(NODES, seconds, logs, on_progress, BEFORE_S)


def live_chain_rows(found: LiveNodes) -> list[MeasuredValue]:
    """Share of a core of both nodes together, and delay of estimates by all of the tow."""
    each = ', '.join(f'{node} {share:.1f} %' for node, share in found.shares.items())
    return [
        share_row(
            'both nodes in real time: share of a core',
            found,
            MOST_OF_CORE,
            f'{each}; the gear as it ships, over {found.wall_s / 60.0:.1f} min of {BAG} behind '
            f'the first {BEFORE_S / 60.0:.0f}; {found.windows} windows at the end',
        ),
        delay_row(
            'both nodes in real time: estimate by all of the tow after its half minute',
            found.motion_delays_s,
            LATEST_S,
            '',
            '. Findings of the watch come 15 s later than what they are of, by design',
        ),
    ]
