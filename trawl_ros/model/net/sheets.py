# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Sheets of a net: the netting around each node, for the lift by its solidity."""

from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray, IntArray
from trawl_ros.model.net.weave import NetBar


@dataclass(frozen=True)
class NetSheets:
    """Sheets of netting, n of them.

    Attributes
    ----------
    around : (n, 5) array
        Own node of each sheet, and the nodes tied to it; filled up with the own node.
    weights : (n, 2, 5) array
        Weights of their positions in both sides d₁, d₂ of `trawl_ros.model.lump_pass`.
    lift, twine : (n,) array
        Coefficient κ and area of twine, m².
    """

    around: IntArray
    weights: FloatArray
    lift: FloatArray
    twine: FloatArray


def sheets_of(bars: list[NetBar], positions: FloatArray) -> NetSheets:
    """Return the sheets at all nodes with two bars of netting side by side, ahead or behind."""
    ahead: dict[int, list[int]] = {}
    behind: dict[int, list[int]] = {}
    lift: dict[int, list[float]] = {}
    twine: dict[int, float] = {}
    for bar in bars:
        if bar.group == 'netting':
            behind.setdefault(bar.start, []).append(bar.end)
            ahead.setdefault(bar.end, []).append(bar.start)
            for node in (bar.start, bar.end):
                lift.setdefault(node, []).append(bar.lift)
                twine[node] = twine.get(node, 0.0) + 0.5 * bar.area * bar.rest
    turn = np.arctan2(positions[:, 1], positions[:, 2])
    around, weights, kappa, area = [], [], [], []
    for node, own in lift.items():
        sides = [
            sorted(there, key=lambda k: float((turn[k] - turn[node] + np.pi) % (2 * np.pi)))
            for there in (ahead.get(node, []), behind.get(node, []))
        ]
        pairs = [there for there in sides if len(there) == 2]
        if not pairs or max(map(len, sides)) > 2 or not any(own):
            continue
        # d₁ = mean place of the nodes behind - of those ahead; an end without nodes is the node.
        long, wide = dict.fromkeys([node, *sides[0], *sides[1]], 0.0), {}
        for there, sign in zip(sides, (-1.0, 1.0), strict=True):
            for k in there or [node]:
                long[k] += sign / max(len(there), 1)
        # d₂ = half of (right - left), the mean of ahead and behind: a node has half of the area
        # |d₁ × d₂| between the nodes tied to it.
        for left, right in pairs:
            wide[left] = -0.5 / len(pairs)
            wide[right] = 0.5 / len(pairs)
        nodes = list(long)
        spare = [0.0] * (5 - len(nodes))
        around.append(nodes + [node] * len(spare))
        weights.append([[*long.values(), *spare], [*(wide.get(k, 0.0) for k in nodes), *spare]])
        kappa.append(float(np.mean(own)))
        area.append(twine[node])
    return NetSheets(
        np.array(around, int).reshape(-1, 5),
        np.array(weights).reshape(-1, 2, 5),
        np.array(kappa),
        np.array(area),
    )
