# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Faults that show without any effect: units, log over ground, frozen sensors, fallen boards."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from trawl_ros.effects.base.effect import Effect
from trawl_ros.estimation.fit.parameters import ParameterVector
from trawl_ros.estimation.screening import Screening
from trawl_ros.estimation.windows.over_ground import OverGround
from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.records.channels import CHANNELS
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.solver.predict import Predictor

UNIT = 'wrong unit'
JUDGED = 5
"""So many steady states are asked for their units: all of a tow have the same."""

FROZEN_STATES, FROZEN_LENGTHS, FROZEN_NOISE = 3, 1.5, 4.0
"""A sensor is frozen that shows the same in at least so many states of a tow, between which the
warps become so many times as long, within so many times its noise."""


FALLEN_SPREAD = 0.4
"""Part of the median spread of all windows below which the boards have fallen over: no change of
a gear that still spreads its doors takes away so much."""


def wrong_unit(
    predictor: Predictor, prior: ParameterVector, windows: Sequence[SteadyWindow]
) -> str | None:
    """Sentence on a channel that reports in another unit; None where none is found."""
    screening = Screening(predictor, prior, OBSERVABLES)
    for window in windows[:: max(1, len(windows) // JUDGED)]:
        rejected = screening.judge(window, prior.start).found
        if rejected is not None and rejected.reason == UNIT:
            return rejected.detail
    return None


def over_ground(windows: Sequence[SteadyWindow], tows: Sequence[str]) -> tuple[str, ...]:
    """Sentences on tows whose log gives speed over ground."""
    judge, sentences = OverGround(), {}
    for window in sorted(windows, key=lambda window: (window.tow, window.start_ns)):
        sentence = judge.judge(window.tow, window.track)
        if sentence is not None:
            sentences[window.tow] = f'{tows[window.tow]}: {sentence}.'
    return tuple(sentences.values())


@dataclass(frozen=True)
class FrozenSensor:
    """Frozen sensor: the tow and the channel in which it shows one value, and a sentence on it.

    ``value`` and ``std`` are mean and scatter of what it shows, in the channel's unit.
    """

    tow: int
    channel: str
    value: float
    std: float
    sentence: str

    def __str__(self) -> str:
        return (
            f'{self.channel.replace("_", " ")} in tow {self.tow + 1}, {self.value:.4g} '
            f'{CHANNELS[self.channel].unit} throughout'
        )


def frozen(windows: Sequence[SteadyWindow], tows: Sequence[str]) -> tuple[FrozenSensor, ...]:
    """Sensors that show the same value whatever the warps.

    Depths, spread and tension all change with the length of the warps; readings that scatter
    around one value pass for those of a working sensor in each state alone.
    """
    found = []
    for tow in sorted({window.tow for window in windows}):
        own = [window for window in windows if window.tow == tow]
        for name in (name for name, channel in CHANNELS.items() if channel.settles):
            shown = [window for window in own if name in window.means]
            if len({window.state for window in shown}) < FROZEN_STATES:
                continue
            lengths = [window.means['port_length'] for window in shown]
            values = [window.means[name] for window in shown]
            noise = float(np.median([window.noise[name] for window in shown]))
            same = float(np.ptp(values)) < FROZEN_NOISE * noise
            if same and max(lengths) > FROZEN_LENGTHS * min(lengths):
                value = float(np.mean(values))
                sentence = (
                    f'{tows[tow]}: {name.replace("_", " ")} ({CHANNELS[name].topic}) stays at '
                    f'{value:.4g} {CHANNELS[name].unit} from {min(lengths):.0f} to '
                    f'{max(lengths):.0f} m of warp: the sensor is frozen, and its '
                    'readings of this tow are left out.'
                )
                found.append(FrozenSensor(tow, name, value, float(np.std(values)), sentence))
    return tuple(found)


def without(
    windows: Sequence[SteadyWindow], sensors: Sequence[FrozenSensor]
) -> tuple[SteadyWindow, ...]:
    """Windows without the readings of frozen sensors, which say nothing of the gear."""

    def kept(window: SteadyWindow) -> SteadyWindow:
        lost = {sensor.channel for sensor in sensors if sensor.tow == window.tow}

        def rest(own: Mapping[str, float]) -> dict[str, float]:
            return {name: value for name, value in own.items() if name not in lost}

        return replace(
            window,
            means=rest(window.means),
            noise=rest(window.noise),
            bias=rest(window.bias),
            to_come=rest(window.to_come),
        )

    return tuple(kept(window) for window in windows) if sensors else tuple(windows)


def standing(
    windows: Sequence[SteadyWindow], tows: Sequence[str]
) -> tuple[tuple[SteadyWindow, ...], tuple[str, ...]]:
    """Windows in which the boards stand, with a sentence on each state in which they do not.

    Boards that lie over are towed as steadily as others, but no steady state with boards that
    stand is like theirs, whatever the effect.
    """
    spread = [window.means.get('door_spread', np.nan) for window in windows]
    usual = float(np.nanmedian(spread)) if np.isfinite(spread).any() else 0.0
    kept, sentences = [], {}
    for window, own in zip(windows, spread, strict=True):
        if not own < FALLEN_SPREAD * usual:
            kept.append(window)
            continue
        sentences[window.state] = (
            f'{tows[window.tow]}: the doors were {own:.0f} m apart with '
            f'{window.means["port_length"]:.0f} m of warp at {window.means["speed"]:.1f} m/s, '
            f'where {usual:.0f} m are usual: a board had fallen over, and this state is left out.'
        )
    return tuple(kept), tuple(sentences.values())


def possible(
    effects: Mapping[str, Effect], windows: Sequence[SteadyWindow]
) -> tuple[Mapping[str, Effect], tuple[str, ...]]:
    """Effects that the depth of the water does not rule out, with a sentence on each."""
    lowest, seabed = np.array(
        [
            (
                window.means.get('net_depth', np.nan)
                + window.means.get('vertical_opening', np.nan),
                np.nan if window.seabed is None else window.seabed,
            )
            for window in windows
        ]
    ).T
    there = {name: own for name, own in effects.items() if own.is_possible(lowest, seabed)}
    sentences = tuple(
        f'{name.replace("_", " ").capitalize()} is not looked for: the echo sounder shows '
        f'{np.nanmin(seabed):.0f} m at least, and the lower edge of the net was at '
        f'{np.nanmax(lowest):.0f} m at most.'
        for name in effects
        if name not in there
    )
    return there, sentences
