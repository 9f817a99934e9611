# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""`autotrawl_node`: works the winches by what counters and load cells say."""

import math
import time
from collections.abc import Sequence
from typing import Any, ClassVar

from trawl_ros.control.autotrawl import Autotrawl
from trawl_ros.control.autotrawl_records import AutotrawlSettings
from trawl_ros.core.errors import MessageError
from trawl_ros.core.time import SECOND
from trawl_ros.messages.commands import WINCH_COMMAND, winch_command
from trawl_ros.messages.diagnostics import OK, WARN, Status
from trawl_ros.nodes.runtime.credit import ConsumerProgress
from trawl_ros.nodes.runtime.node import TrawlNode
from trawl_ros.nodes.runtime.parameters import Number, Text
from trawl_ros.nodes.runtime.qos import CONSUMER
from trawl_ros.nodes.runtime.reading import possible_sample
from trawl_ros.nodes.runtime.run import run
from trawl_ros.records.samples import WinchSample
from trawl_ros.records.towing_limits import LIMITS

WINCH = 'winch/joint_states'
OFF = 'off'
BACK_NS = SECOND
"""Stamps that go back by more than this are those of a tow that has begun again."""

SILENT_S = 5.0
DEFAULT = AutotrawlSettings()


class AutotrawlNode(TrawlNode):
    """Node that holds set lengths or equal tension, as `trawl_ros.control.autotrawl` says.

    It answers each sample of ``winch/joint_states`` with a ``command/winch``; without samples it
    sends nothing, so the winches hold. It takes over with the lengths that the counters show.
    """

    SPECS: ClassVar = (
        Text('mode', OFF, 'lengths holds set lengths by the counters; tension holds both warps at '
             'equal tension and gives way to peaks; off sends nothing.',
             choices=('lengths', 'tension', OFF), live=True),
        Number('port_length_m', 0.0, 'm', 0.0, LIMITS.warp_m[1],
               'Length to be held on port; in mode tension '
               'the mean of both is. 0 is what the counter shows at the start.', live=True),
        Number('starboard_length_m', 0.0, 'm', 0.0, LIMITS.warp_m[1],
               'The same on starboard.', live=True),
        Number('tension_kn', 0.0, 'kN', 0.0, 2000.0, 'Tension of one warp above which is given '
               'way; 0 is the mean of the last minutes.', live=True),
        Number('balance_gain_m_s', DEFAULT.balance_gain, 'm/s', 0.0, 5.0, 'Speed at which warp is '
               'moved from one side to the other per relative difference in tension.', live=True),
        Number('give_gain_m_s', DEFAULT.give_gain, 'm/s', 0.0, 5.0, 'Speed at which 500 m of warp '
               'are paid out per relative excess of the tension.', live=True),
        Number('haul_gain_m_s', DEFAULT.haul_gain, 'm/s', 0.0, 5.0, 'Speed at which they are '
               'hauled back per relative want of tension.', live=True),
        Number('max_give_m', DEFAULT.max_give_m, 'm', 0.0, 50.0, 'Most that is given on one side.',
               live=True),
        Number('max_difference_percent', 100 * DEFAULT.max_difference, '%', 0.0, 10.0,
               'Most difference between the warps for equal tension, of their length.', live=True),
        Number('max_speed_m_s', DEFAULT.max_speed, 'm/s', 0.01, 3.0, 'Fastest the winches may run.',
               live=True),
        Number('max_acceleration_m_s2', DEFAULT.max_acceleration, 'm/s2', 0.01, 3.0, 'How fast the '
               'winches get up speed.', live=True),
    )  # fmt: skip

    def __init__(self, **kwargs: Any) -> None:
        super().__init__('autotrawl_node', **kwargs)
        self._autotrawl: Autotrawl | None = None
        self._latest: int | None = None
        self._heard_at = time.monotonic()
        self._found = (math.nan, math.nan)
        self.advertise(WINCH_COMMAND)
        self._progress = ConsumerProgress(self, idle=lambda: True)
        self.listen(WINCH, self._take, CONSUMER, settled=True)

    def parameter_changed(self, name: str) -> None:
        """Apply a live parameter's new value."""
        if self.parameters['mode'] == OFF:
            self._autotrawl = None
        elif self._autotrawl is not None:
            self._autotrawl.change(self._settings())
            self._autotrawl.set_lengths(*self._wanted_lengths())

    def statuses(self) -> list[Status]:
        """Return the status of the warps."""
        if self._autotrawl is None:
            mode = self.parameters['mode']
            message = 'off' if mode == OFF else self.with_namespace(f'waits for {WINCH}')
            return [Status('autotrawl', OK if mode == OFF else WARN, message, {'mode': mode})]
        state = self._autotrawl.state()
        values = {
            'mode': self.parameters['mode'],
            'set port length': f'{state.set_lengths[0]:.1f}',
            'set starboard length': f'{state.set_lengths[1]:.1f}',
            'wanted port length': f'{state.wanted[0]:.2f}',
            'wanted starboard length': f'{state.wanted[1]:.2f}',
            'difference in tension': f'{state.difference:.4f}',
            'balance': f'{state.balance:.2f}',
            'given on port': f'{state.given[0]:.2f}',
            'given on starboard': f'{state.given[1]:.2f}',
            'at its bound': ', '.join(state.saturated),
            'sensors': ', '.join(state.problems),
        }
        problems = [f'{problem}, what hangs on it is held' for problem in state.problems]
        problems += [f'{name} is at its bound' for name in state.saturated]
        silent = time.monotonic() - self._heard_at
        if silent > SILENT_S:
            problems.append(f'{WINCH} silent for {silent:.0f} s, the winches hold')
        level = WARN if problems else OK
        return [Status('autotrawl', level, '; '.join(problems) or 'holds the warps', values)]

    def _settings(self) -> AutotrawlSettings:
        given = self.parameters
        return AutotrawlSettings(
            mode='lengths' if given['mode'] == 'lengths' else 'tension',
            tension=1e3 * given['tension_kn'] or math.nan,
            balance_gain=given['balance_gain_m_s'],
            give_gain=given['give_gain_m_s'],
            haul_gain=given['haul_gain_m_s'],
            max_give_m=given['max_give_m'],
            max_difference=0.01 * given['max_difference_percent'],
            max_speed=given['max_speed_m_s'],
            max_acceleration=given['max_acceleration_m_s2'],
        )

    def _wanted_lengths(self) -> tuple[float, float]:
        port, starboard = self._found
        return (
            self.parameters['port_length_m'] or port,
            self.parameters['starboard_length_m'] or starboard,
        )

    def _take(self, message: Any) -> None:
        sample = possible_sample(WINCH, message)
        if not isinstance(sample, WinchSample):
            raise MessageError(f'{WINCH}: expected counters and load cells')
        if self._latest is not None and sample.stamp < self._latest - BACK_NS:
            self._autotrawl = None
        self._latest = sample.stamp
        self._heard_at = time.monotonic()
        self._work(sample)
        self._progress.done(sample.stamp)

    def _work(self, sample: WinchSample) -> None:
        if self.parameters['mode'] == OFF:
            return
        if self._autotrawl is None:
            if not all(map(math.isfinite, sample.lengths)):
                return
            self._found = sample.lengths
            self._autotrawl = Autotrawl(self._settings(), self._found)
            self._autotrawl.set_lengths(*self._wanted_lengths())
        self.send(*winch_command(sample.stamp, *self._autotrawl.update(sample)))


def main(args: Sequence[str] | None = None) -> int:
    """Run the node."""
    return run(AutotrawlNode, args)
