# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Window finder: steady windows in a stream of samples.

Windows lie on a grid of header stamps, and a window is decided only when all channels that
speak have passed its end less their delay. So the result does not depend on when samples
arrive or how channels interleave, as long as they do by less than half the stated patience.
Memory is bounded by one window of readings per channel.
"""

import math
from collections import Counter
from collections.abc import Callable, Sequence

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.windows.buffers import channel_buffers
from trawl_ros.estimation.windows.channel_means import ChannelMean, channel_mean
from trawl_ros.estimation.windows.operation import Block, Operation, Unheld
from trawl_ros.estimation.windows.over_ground import ground_track
from trawl_ros.estimation.windows.records import (
    RejectedWindow,
    Rejections,
    SteadyWindow,
    WindowOptions,
)
from trawl_ros.estimation.windows.sounder import Sounder
from trawl_ros.estimation.windows.statistics import circular_median
from trawl_ros.estimation.windows.watermark import NANO, Watermark
from trawl_ros.records.channels import CHANNELS, INPUTS, REQUIRED, WITNESSES, readings
from trawl_ros.records.samples import Sample

WINCH = INPUTS[:2]


class SteadyWindowFinder:
    """Streaming finder of steady windows.

    Parameters
    ----------
    pressure_to_depth
        Depth (m) for an absolute pressure (Pa).
    options
        Criteria of a steady window.
    required
        Channels without which no window is made.

    Attributes
    ----------
    rejections : Rejections
        Counts by reason, of what `REASONS` says, and what was found.
    arrived, readings : Counter
        Channel → readings that came, and those of them that were accepted.
    settle_s : float
        Longest time (s) of settling that any warp lengths and speed so far asked for.
    """

    def __init__(
        self,
        pressure_to_depth: Callable[[float], float],
        options: WindowOptions | None = None,
        required: Sequence[str] = REQUIRED,
    ) -> None:
        self._required = frozenset(required)
        self._pressure_to_depth = pressure_to_depth
        self._options = options or WindowOptions()
        self._block_ns = round(self._options.block_s * NANO)
        self.reset()

    def reset(self) -> None:
        """Reset to no data: time has jumped back."""
        self.rejections = Rejections()
        self.arrived: Counter[str] = Counter()
        self.readings: Counter[str] = Counter()
        self.settle_s = self._options.settle_s
        self._windows = 0
        self._state = -1
        self._tow = -1
        self._begin_tow()
        self._clear()

    def _clear(self) -> None:
        self._winch_watermark = Watermark()
        self._buffers = channel_buffers(self._options, self._winch_watermark, self.rejections)
        self._operation = Operation(self._options)
        self._sounder = Sounder()
        self._next_block: int | None = None
        self._last_winch: int | None = None

    def _begin_tow(self) -> None:
        self._tow += 1
        self._in_state = 0
        self._held = False
        self._reference: FloatArray | None = None
        self._last_end = 0
        self._stretch: tuple[str, bool] | None = None
        self._began: int | None = None

    def newest(self, channel: str) -> int | None:
        """Newest stamp (ns) accepted on a channel."""
        return self._buffers[channel].newest

    @property
    def rejected(self) -> Counter[str]:
        """Counts of rejections by reason."""
        return self.rejections.counts

    def feed(self, sample: Sample) -> list[SteadyWindow | RejectedWindow]:
        """Take one sample; return what could be decided with it, in order of time."""
        self._sounder.add(sample)
        for reading in readings(sample, self._pressure_to_depth):
            # Most ships have no yaw rate on the log: NaN there is no fault to be counted.
            if reading.channel == 'yaw_rate' and not math.isfinite(reading.value):
                continue
            name = reading.channel
            self.arrived[name] += 1
            self.readings[name] += self._buffers[name].add(reading)
        return self._advance(self._watermark()) if self._block_may_end() else []

    def finish(self) -> list[SteadyWindow | RejectedWindow]:
        """Decide the remaining windows: no more samples will come."""
        for buffer in self._buffers.values():
            buffer.order.give_up()
        lead = self._winch_watermark.lead
        return [] if lead is None else self._advance(lead + 1)

    def next_tow(self) -> list[SteadyWindow | RejectedWindow]:
        """Decide the remaining windows of this tow and begin the next; states and counts go on."""
        decided = self.finish()
        if any(buffer.newest is not None for buffer in self._buffers.values()):
            self._begin_tow()
        self._clear()
        return decided

    def _block_may_end(self) -> bool:
        """True if the winches, which the watermark never passes, are beyond the present block."""
        lead = self._winch_watermark.lead
        if lead is None:
            return False
        return self._next_block is None or lead // self._block_ns > self._next_block

    def _watermark(self) -> int | None:
        """Watermark: stamp (ns) that all channels have passed that are waited for."""
        lead = self._winch_watermark.lead
        if lead is None:
            return None
        patience = round(self._options.patience_s * NANO)
        reorder = round(self._options.reorder_s * NANO)
        begins = lead < self._winch_watermark.start + patience
        passed = lead
        for name, buffer in self._buffers.items():
            if buffer.newest is None:
                if begins and CHANNELS[name].usual:
                    return None
            elif begins or buffer.newest + buffer.delay >= lead - patience:
                passed = min(passed, buffer.newest + buffer.delay - reorder)
        return passed

    def _advance(self, watermark: int | None) -> list[SteadyWindow | RejectedWindow]:
        if watermark is None or self._winch_watermark.first is None:
            return []
        if self._next_block is None:
            self._next_block = self._winch_watermark.first // self._block_ns
        decided: list[SteadyWindow | RejectedWindow] = []
        end_block = watermark // self._block_ns
        history = self._operation.most_blocks
        if end_block - self._next_block > 2 * history:
            # A hole longer than any look-back needs no block by block walk.
            start_ns, end_ns = self._next_block * self._block_ns, end_block * self._block_ns
            if all(len(self._buffers[name].window(start_ns, end_ns)[0]) == 0 for name in WINCH):
                self._next_block = end_block - history
        while self._next_block < end_block:
            decided.extend(self._block(self._next_block))
            self._next_block += 1
        return decided

    def _block(self, index: int) -> list[SteadyWindow | RejectedWindow]:
        end_ns = (index + 1) * self._block_ns
        self._look_for_tow(end_ns - self._block_ns, end_ns)
        self._operation.add(self._summary(index))
        self.settle_s = max(self.settle_s, self._operation.settle_s)
        start_ns = end_ns - self._operation.window_blocks * self._block_ns
        decided = self._decide(start_ns, end_ns) if self._operation.full else []
        for buffer in self._buffers.values():
            buffer.decide(end_ns, start_ns + self._block_ns)
        return decided

    def _look_for_tow(self, start_ns: int, end_ns: int) -> None:
        stamps = np.concatenate([self._buffers[name].window(start_ns, end_ns)[0] for name in WINCH])
        if len(stamps) == 0:
            return
        gap = round(self._options.tow_gap_s * NANO)
        if self._last_winch is not None and stamps.min() - self._last_winch > gap:
            self._begin_tow()
        if self._began is None:
            self._began = int(stamps.min())
        self._last_winch = int(stamps.max())

    def _hours(self, stamp: float) -> float:
        """Time since the tow began, h."""
        return 0.0 if self._began is None else (stamp - self._began) / (3600.0 * NANO)

    def _summary(self, index: int) -> Block:
        def values(name: str) -> FloatArray:
            start_ns = index * self._block_ns
            return self._buffers[name].window(start_ns, start_ns + self._block_ns)[1]

        def median(name: str) -> float | None:
            return float(np.median(block)) if len(block := values(name)) else None

        heading = values('heading')
        return Block(
            index,
            (median(INPUTS[0]), median(INPUTS[1]), median(INPUTS[2])),
            circular_median(heading) if len(heading) else None,
            median('yaw_rate'),
        )

    def _decide(self, start_ns: int, end_ns: int) -> list[SteadyWindow | RejectedWindow]:
        unheld = self._operation.unheld()
        if unheld is not None:
            self._held = False
            return self._reject(unheld, False, start_ns, end_ns)
        inputs = self._operation.inputs()
        known = self._held and self._in_state > 0 and self._same_state(inputs)
        if known and (
            self._in_state >= self._options.max_windows_per_state or start_ns < self._last_end
        ):
            return []
        window = self._window(start_ns, end_ns, self._state if known else self._state + 1)
        if isinstance(window, Unheld):
            return self._reject(window, True, start_ns, end_ns)
        if not known:
            self._state += 1
            self._in_state = 0
            self._reference = inputs
        self._held = True
        self._stretch = None
        self._in_state += 1
        self._windows += 1
        self._last_end = end_ns
        return [window]

    def _same_state(self, inputs: FloatArray) -> bool:
        if self._reference is None:
            return False
        tolerance = np.array(
            [*(self._options.length_tolerance,) * 2, self._options.speed_tolerance]
        )
        return bool(np.all(np.abs(inputs - self._reference) <= tolerance))

    def _reject(
        self, why: Unheld, held: bool, start_ns: int, end_ns: int
    ) -> list[SteadyWindow | RejectedWindow]:
        # A rejection that goes on for the same reason counts once, however long it lasts.
        stretch = (why.reason, held)
        if stretch == self._stretch:
            return []
        self._stretch = stretch
        self.rejections.add(why.reason, why.detail)
        return [RejectedWindow(why.reason, start_ns, end_ns, why.detail)]

    def _window(self, start_ns: int, end_ns: int, state: int) -> SteadyWindow | Unheld:
        used: dict[str, ChannelMean] = {}
        lost: list[Unheld] = []
        for name in CHANNELS:
            buffer = self._buffers[name]
            silent = not buffer.heard(end_ns) and len(buffer.outside(start_ns, end_ns)) == 0
            if name in WITNESSES or (silent and name not in self._required):
                continue
            mean = channel_mean(buffer, start_ns, end_ns, self._options)
            if isinstance(mean, ChannelMean):
                used[name] = mean
            elif name in self._required:
                return mean
            else:
                lost.append(mean)
        for why in lost:
            self.rejections.add(why.reason, why.detail)
        for name, mean in used.items():
            if mean.excluded:
                sentence = f'{name} ({CHANNELS[name].topic}) has {mean.excluded} outliers'
                self.rejections.add('outlier', sentence, mean.excluded)
        return SteadyWindow(
            self._windows,
            state,
            start_ns,
            end_ns,
            means={name: mean.mean for name, mean in used.items()},
            noise={name: mean.noise for name, mean in used.items()},
            to_come={name: mean.to_come for name, mean in used.items()},
            bias={name: CHANNELS[name].bias_std(mean.mean) for name, mean in used.items()},
            counts={name: mean.count for name, mean in used.items()},
            tow=self._tow,
            hours=self._hours(0.5 * (start_ns + end_ns)),
            track=ground_track(
                *(
                    self._buffers[name].window(start_ns, end_ns)[:2]
                    for name in ('speed', 'ground_east', 'ground_north', 'heading')
                )
            ),
            seabed=self._sounder.depth(start_ns, end_ns),
        )
