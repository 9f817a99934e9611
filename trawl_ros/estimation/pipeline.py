# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Identification pipeline: from samples to estimates, shared by node and ``trawl identify``."""

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from trawl_ros.estimation.fit.estimate import Estimate
from trawl_ros.estimation.fit.estimator import Estimator
from trawl_ros.estimation.fit.estimator_options import EstimatorOptions
from trawl_ros.estimation.fit.parameters import ParameterVector
from trawl_ros.estimation.fit.prediction import SteadyPredictor
from trawl_ros.estimation.screening import Screening
from trawl_ros.estimation.window_gate import WindowGate
from trawl_ros.estimation.windows.finder import SteadyWindowFinder
from trawl_ros.estimation.windows.records import (
    REASONS,
    RejectedWindow,
    SteadyWindow,
    WindowOptions,
)
from trawl_ros.estimation.windows.watermark import NANO
from trawl_ros.records.channels import CHANNELS, REQUIRED
from trawl_ros.records.samples import Sample

ONE_CLOCK_S = 3600.0
"""Channels whose newest stamps lie further apart than this (s) are on different clocks."""

NO_WINDOW = 'no steady window was found'
"""Beginning of the reason for which sound readings give no estimate."""


@dataclass(frozen=True)
class WindowUsed:
    """Event: a steady window was used, with the estimate after it."""

    window: SteadyWindow
    estimate: Estimate


Event = WindowUsed | RejectedWindow


class Identification:
    """Identification pipeline behind one method, `feed`.

    Parameters
    ----------
    predictor, prior, observables
        The model of the gear, where its coefficients start, and the names of what it predicts.
    pressure_to_depth
        Depth (m) for an absolute pressure (Pa).
    window_options, estimator_options
        Criteria of a steady window; options of the estimator.

    Attributes
    ----------
    course : list of WindowUsed
        The windows that were used, each with the estimate after it.
    """

    def __init__(
        self,
        predictor: SteadyPredictor,
        prior: ParameterVector,
        observables: Sequence[str],
        pressure_to_depth: Callable[[float], float],
        window_options: WindowOptions | None = None,
        estimator_options: EstimatorOptions | None = None,
    ) -> None:
        self.window_options = window_options or WindowOptions()
        self.finder = SteadyWindowFinder(pressure_to_depth, self.window_options)
        self.estimator = Estimator(predictor, prior, observables, estimator_options)
        self.gate = WindowGate(Screening(predictor, prior, observables))
        self.course: list[WindowUsed] = []

    def reset(self) -> None:
        """Reset to no data: time has jumped back."""
        self.finder.reset()
        self.estimator.reset()
        self.gate.reset()
        self.course = []

    def feed(self, sample: Sample) -> list[Event]:
        """Take one sample; return the windows it decided, with the estimates they led to."""
        return self._use(self.finder.feed(sample))

    def finish(self) -> list[Event]:
        """Decide the remaining windows and bring the estimate to convergence."""
        events = self._use(self.finder.finish())
        self.estimator.finish()
        return events

    def next_tow(self) -> list[Event]:
        """Decide the remaining windows of this tow; later samples belong to another."""
        return self._use(self.finder.next_tow())

    def take(self, windows: Sequence[SteadyWindow]) -> list[Event]:
        """Use windows from other finders, one after another."""
        return self._use(windows)

    @property
    def estimate(self) -> Estimate | None:
        """Newest estimate."""
        return self.estimator.estimate

    @property
    def rejected(self) -> dict[str, int]:
        """Counts of rejections by reason, without zeros, in the order of `REASONS`."""
        counts = Counter(self.finder.rejected)
        counts.update(self.gate.rejections.counts)
        counts['no steady state'] += self.estimator.without_steady_state
        return {reason: counts[reason] for reason in REASONS if counts[reason]}

    @property
    def found(self) -> dict[str, str]:
        """Last finding by reason, in one sentence; in the order of `REASONS`."""
        sentences = self.finder.rejections.sentences | self.gate.rejections.sentences
        return {reason: sentences[reason] for reason in REASONS if reason in sentences}

    def missing_channels(self) -> tuple[str, ...]:
        """Required channels without any usable reading."""
        return tuple(name for name in REQUIRED if not self.finder.readings[name])

    def why_not(self) -> str | None:
        """Reason in one sentence why there is no estimate; None when there is one."""
        if self.estimate is not None:
            return None
        if missing := self.missing_channels():
            return self._about_missing(missing)
        if clocks := self._about_clocks():
            return clocks
        counts = ', '.join(f'{reason} {count}' for reason, count in self.rejected.items())
        options = self.window_options
        return (
            f'{NO_WINDOW}, so nothing is estimated: one needs warp lengths, speed '
            f'and heading held for up to {self.finder.settle_s:.0f} s here '
            f'({options.settle_passages:g} gear lengths towed) and then for {options.window_s:g} s '
            f'of steady readings (rejected: {counts or "none"})'
        )

    def _about_missing(self, missing: Sequence[str]) -> str:
        arrived = self.finder.arrived
        silent = dict.fromkeys(CHANNELS[name].topic for name in missing if not arrived[name])
        phrases = [f'no readings on {", ".join(silent)}'] if silent else []
        phrases += [f'none usable of {arrived[n]} of {n}' for n in missing if arrived[n]]
        return f'nothing is estimated: {"; ".join(phrases)}'

    def _about_clocks(self) -> str | None:
        stamps = {name: self.finder.newest(name) or 0 for name in REQUIRED}
        first, last = min(stamps, key=stamps.__getitem__), max(stamps, key=stamps.__getitem__)
        apart = (stamps[last] - stamps[first]) / NANO
        if apart < ONE_CLOCK_S:
            return None
        return (
            f'{CHANNELS[first].topic} is stamped {apart:.0f} s before {CHANNELS[last].topic}: '
            f'two clocks, expected one, so nothing is estimated'
        )

    def _use(self, decided: Sequence[SteadyWindow | RejectedWindow]) -> list[Event]:
        events: list[Event] = []
        for item in decided:
            if isinstance(item, RejectedWindow):
                events.append(item)
                continue
            gated = self.gate.judge(item, self.estimator.coefficients)
            if gated.withdraw:
                self._withdraw(item.tow)
            if gated.rejected is not None:
                events.append(gated.rejected)
            if gated.window is None:
                continue
            item = gated.window
            estimate = self.estimator.add(item, gated.near)
            if estimate is None:
                lengths = f'{item.means["port_length"]:.0f} m'
                speed = f'{item.means["speed"]:.2f} m/s'
                events.append(
                    RejectedWindow(
                        'no steady state',
                        item.start_ns,
                        item.end_ns,
                        f'the model finds none at {lengths} of warp and {speed}',
                    )
                )
            else:
                self.course.append(WindowUsed(item, estimate))
                events.append(self.course[-1])
        return events

    def _withdraw(self, tow: int) -> None:
        """Repeat the estimate without the windows of a tow."""
        if all(used.window.tow != tow for used in self.course):
            return
        remaining = [used.window for used in self.course if used.window.tow != tow]
        self.estimator.reset()
        self.course = []
        for window in remaining:
            estimate = self.estimator.add(window)
            if estimate is not None:
                self.course.append(WindowUsed(window, estimate))
