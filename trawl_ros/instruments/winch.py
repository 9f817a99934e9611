# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Instruments of the winches: counters, pay-out speeds and load cells."""

import math

from trawl_ros.instruments.errors.instrument import Instrument, SeedPlan
from trawl_ros.instruments.parameters import WinchParameters
from trawl_ros.records.samples import Sample, WinchSample
from trawl_ros.records.truth import SIDES, Truth, WinchTruth


class CountingWheel:
    """Counting wheel: counts the wire that passes, stretched by its tension.

    Parameters
    ----------
    stiffness
        EA of the wire, N; None if it does not stretch.
    calibrated_at
        Tension (N) at which a counted metre is a metre of unstretched wire.
    """

    def __init__(self, stiffness: float | None, calibrated_at: float) -> None:
        self._stiffness = stiffness
        self._calibrated_at = calibrated_at
        self._counted: float | None = None
        self._before = 0.0

    def count(self, length: float, tension: float) -> float:
        """Return the counted length (m) at an unstretched ``length`` (m) and ``tension`` (N)."""
        if self._stiffness is None:
            return length
        stretch = 1.0 + (tension - self._calibrated_at) / self._stiffness
        # The counter is set by the marks on the wire before the tow, so it starts without error.
        if self._counted is None or not math.isfinite(self._counted):
            self._counted = length
        else:
            self._counted += (length - self._before) * stretch
        self._before = length
        return self._counted


class LoadCell:
    """Load cell with friction: its force lags the tension by up to ``play`` (N)."""

    def __init__(self, play: float) -> None:
        self._play = play
        self._felt: float | None = None

    def feel(self, tension: float) -> float:
        """Return the force (N) on the cell."""
        before = tension if self._felt is None or math.isnan(self._felt) else self._felt
        self._felt = min(max(before, tension - self._play), tension + self._play)
        return self._felt


class WinchInstrument(Instrument[tuple[WinchTruth, WinchTruth], WinchSample]):
    """Instrument of both winches, port first, which reports one sample for both."""

    def __init__(self, parameters: WinchParameters, draws: SeedPlan) -> None:
        quantities = {
            'length': parameters.length,
            'speed': parameters.speed,
            'tension': parameters.tension,
        }
        errors = {
            f'{side}/{name}': channel.model()
            for side in SIDES
            for name, channel in quantities.items()
        }
        self._parameters = parameters
        super().__init__('winch/joint_states', parameters.timing(), errors, draws)

    def _restart(self) -> None:
        record = self._parameters
        stiffness = record.wire_stiffness_mn and 1e6 * record.wire_stiffness_mn
        self._wheels = [CountingWheel(stiffness, 1e3 * record.calibrated_at_kn) for _ in SIDES]
        self._cells = [LoadCell(1e3 * record.hysteresis_kn) for _ in SIDES]

    def observe(self, part: tuple[WinchTruth, WinchTruth], stamp: int) -> list[WinchSample]:
        """Observe both winches; wheels and cells follow the truth between samples too."""
        samples = super().observe(part, stamp)
        self._turn(part)
        return samples

    def _turn(self, part: tuple[WinchTruth, WinchTruth]) -> tuple[list[float], list[float]]:
        counted = [w.count(t.length, t.tension) for w, t in zip(self._wheels, part, strict=True)]
        felt = [c.feel(t.tension) for c, t in zip(self._cells, part, strict=True)]
        return counted, felt

    def _read(self, part: tuple[WinchTruth, WinchTruth], stamp: int) -> WinchSample:
        counted, felt = self._turn(part)

        def both(quantity: str, values: list[float]) -> tuple[float, float]:
            port, starboard = (
                self._measure(f'{side}/{quantity}', value, stamp)
                for side, value in zip(SIDES, values, strict=True)
            )
            return port, starboard

        speeds = [winch.speed for winch in part]
        return WinchSample(
            stamp, both('length', counted), both('speed', speeds), both('tension', felt)
        )


class WinchInstruments:
    """Instruments of the winches."""

    def __init__(self, parameters: WinchParameters, draws: SeedPlan) -> None:
        self.winch = WinchInstrument(parameters, draws)
        self.instruments = (self.winch,)

    def observe(self, truth: Truth) -> list[Sample]:
        """Return the samples that are due."""
        return list(self.winch.observe(truth.winches, truth.stamp))
