# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Operation of the gear, block by block: check for inputs held long enough."""

import math
from collections import deque
from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.windows.records import WindowOptions
from trawl_ros.estimation.windows.statistics import circular_median, wrapped
from trawl_ros.records.channels import CHANNELS, INPUTS

SLOWEST = 0.5
"""Speed (m/s) below which the settling time grows no more."""


@dataclass(frozen=True)
class Block:
    """Block of the grid: medians; None where a channel has no readings.

    ``inputs`` are port and starboard warp length (m) and speed (m/s); ``heading`` rad,
    ``yaw_rate`` rad/s.
    """

    index: int
    inputs: tuple[float | None, float | None, float | None]
    heading: float | None
    yaw_rate: float | None


@dataclass(frozen=True)
class Unheld:
    """Reason why the operation is not held: a key of `REASONS` and a description."""

    reason: str
    detail: str


class Operation:
    """Blocks of the last settling time and window, with the check that they are held."""

    def __init__(self, options: WindowOptions) -> None:
        self._options = options
        self.window_blocks = math.ceil(options.window_s / options.block_s)
        longest = max(options.settle_s, options.longest_settle_s)
        self.most_blocks = math.ceil(longest / options.block_s) + self.window_blocks
        self._blocks: deque[Block] = deque(maxlen=self.most_blocks)

    def add(self, block: Block) -> None:
        """Append the next block; one that does not follow the last starts afresh."""
        if self._blocks and block.index != self._blocks[-1].index + 1:
            self._blocks.clear()
        self._blocks.append(block)

    @property
    def settle_s(self) -> float:
        """Time (s) of settling at the warp lengths and speed of the window."""
        options = self._options
        settle = options.settle_s
        window = [block.inputs for block in list(self._blocks)[-self.window_blocks :]]
        if window and all(None not in inputs for inputs in window):
            port, starboard, speed = np.mean(np.array(window, dtype=float), axis=0)
            gear = max(port, starboard) + options.net_length
            passage = gear / max(speed, SLOWEST)
            settle = max(settle, options.settle_passages * passage)
            settle = min(settle, max(options.settle_s, options.longest_settle_s))
        return float(settle)

    @property
    def settle_blocks(self) -> int:
        """Number of blocks of settling at the warp lengths and speed of the window."""
        return math.ceil(self.settle_s / self._options.block_s)

    @property
    def full(self) -> bool:
        """True if settling time and window are both covered."""
        return len(self._blocks) >= self.settle_blocks + self.window_blocks

    def inputs(self) -> FloatArray:
        """Mean inputs (3,) over the window's blocks; only after `unheld` gave None."""
        window = list(self._blocks)[-self.window_blocks :]
        mean: FloatArray = np.mean(
            np.array([block.inputs for block in window], dtype=float), axis=0
        )
        return mean

    def unheld(self) -> Unheld | None:
        """Reason why inputs or heading were not held over settling time and window, or None."""
        blocks = list(self._blocks)[-(self.settle_blocks + self.window_blocks) :]
        for i, name in enumerate(INPUTS):
            silent = sum(block.inputs[i] is None for block in blocks)
            if silent:
                missing = silent == len(blocks)
                return Unheld(
                    'missing channel' if missing else 'gap',
                    f'{name} ({CHANNELS[name].topic}) is silent for '
                    f'{silent * self._options.block_s:g} s',
                )
        mean = self.inputs()
        tolerance = (self._options.length_tolerance,) * 2 + (self._options.speed_tolerance,)
        values = np.array([block.inputs for block in blocks], dtype=float)
        departure = np.max(np.abs(values - mean), axis=0)
        for i, name in enumerate(INPUTS):
            if departure[i] > tolerance[i]:
                unit = CHANNELS[name].unit
                return Unheld(
                    'unsteady',
                    f'{name} moves by {departure[i]:.2f} {unit} in settling time and window, '
                    f'at most {tolerance[i]:g} {unit} is steady',
                )
        return self._turning(blocks)

    def _turning(self, blocks: list[Block]) -> Unheld | None:
        limit = self._options.heading_tolerance
        headings = np.array([block.heading for block in blocks if block.heading is not None])
        if len(headings):
            window = [b.heading for b in blocks[-self.window_blocks :] if b.heading is not None]
            middle = circular_median(np.array(window)) if window else headings[-1]
            turn = float(np.max(np.abs(wrapped(headings - middle))))
            if turn > limit:
                return Unheld(
                    'turning',
                    f'heading changes by {turn:.2f} rad in settling time and window, '
                    f'at most {limit:g} rad is straight',
                )
        rates = [b.yaw_rate for b in blocks if b.yaw_rate is not None]
        if rates:
            turn = abs(float(np.mean(rates))) * self._options.window_s
            if turn > limit:
                return Unheld(
                    'turning',
                    f'the yaw rate turns the ship by {turn:.2f} rad in one window, '
                    f'at most {limit:g} rad is straight',
                )
        return None
