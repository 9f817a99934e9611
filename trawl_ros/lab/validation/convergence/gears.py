# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Steady observables of the default gear and of refined ones."""

from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import NoSteadyState
from trawl_ros.gear.records import GearRecord
from trawl_ros.model.gear_model import GearModel, build_model
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.solver.equilibrium import Equilibrium, find_equilibrium
from trawl_ros.solver.operating_point import OperatingPoint

SPEED = 2.1
"""Speed through the water, m/s."""

STRIDE = 1.15
"""Largest ratio of warp lengths between a state and its start."""

AROUND_ZERO = ('pitch', 'slip')
"""Angles that can be near zero: pitch changes sign with growing warp length."""

REFERENCE = np.radians(30.0)
"""Reference for differences of these angles: 30°, the upper end of Fig. 5 of the paper."""


@dataclass(frozen=True)
class RefinementRow:
    """Observables (lengths, observables) of one gear; NaN for lengths without a steady state."""

    name: str
    nodes: int
    seen: FloatArray


def row(name: str, gear: GearRecord, lengths: tuple[float, ...]) -> RefinementRow:
    """Solve one gear at all warp lengths, from the middle one outward."""
    model = build_model(gear)
    seen = np.full((len(lengths), len(OBSERVABLES)), np.nan)
    middle = len(lengths) // 2
    first = _solved(model, lengths[middle], None)
    for k in sorted(range(len(lengths)), key=lambda k: abs(k - middle)):
        found = first
        # A fine net follows small changes of length more surely than it settles anew.
        count = int(np.ceil(abs(np.log(lengths[k] / lengths[middle])) / np.log(STRIDE)))
        for length in np.geomspace(lengths[middle], lengths[k], count + 1)[1:]:
            found = _solved(model, float(length), found) if found is not None else None
        found = found or _solved(model, lengths[k], None)
        if found is not None:
            seen[k] = found.observables.array()
    return RefinementRow(name, model.nodes, seen)


def _solved(model: GearModel, length: float, start: Equilibrium | None) -> Equilibrium | None:
    try:
        return find_equilibrium(model, OperatingPoint(length, length, SPEED), start)
    except NoSteadyState:
        return None


def differences(seen: FloatArray, fine: FloatArray) -> FloatArray:
    """Differences from the finer gear, as shares of its value.

    Angles around zero are compared with `REFERENCE` instead. The last axis of each array runs over
    the observables.
    """
    around = np.array([name.endswith(AROUND_ZERO) for name in OBSERVABLES])
    return (seen - fine) / np.where(around, REFERENCE, np.abs(fine))
