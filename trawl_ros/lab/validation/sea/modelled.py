# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Published hauls with their steady states in the model."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from trawl_ros.core.errors import NoSteadyState
from trawl_ros.gear.load import load_gear
from trawl_ros.gear.records import GearRecord
from trawl_ros.lab.validation.sea.changes import value_of
from trawl_ros.lab.validation.sea.published import GearHauls, HaulRecord, PointRecord, TrendRecord
from trawl_ros.lab.validation.sea.quantities import quantities
from trawl_ros.model.gear_model import build_model
from trawl_ros.records.observables import Observables
from trawl_ros.solver.equilibrium import Equilibrium, steady_state


@dataclass(frozen=True)
class ModelledHaul:
    """Haul with the quantities of its steady state, or the reason why it has none."""

    gear: GearHauls
    haul: HaulRecord
    observables: Observables | None
    refusal: str = ''
    derived: Mapping[str, float] = field(default_factory=dict)

    def value(self, quantity: str) -> float:
        """Observable or derived quantity of this name; NaN without a steady state."""
        return value_of(self.observables, self.derived, quantity)

    def error(self, point: PointRecord) -> float:
        """Error of the model (%) at a point; infinite without a steady state."""
        value = self.value(point.quantity)
        return math.inf if math.isnan(value) else 100.0 * (value / point.value - 1.0)


def gear_record(gear: GearHauls, *, quick: bool) -> GearRecord:
    """Gear of these hauls; with ``quick``, its net cut coarsely."""
    record = load_gear(gear.gear)
    return record.refined(net=0.4) if quick else record


def modelled(gear: GearHauls, *, quick: bool) -> list[ModelledHaul]:
    """Find the steady state of each haul: cold, or else from the hauls before it."""
    record = gear_record(gear, quick=quick)
    results: list[ModelledHaul] = []
    known: list[Equilibrium] = []
    for haul in gear.hauls:
        model = build_model(haul.rigged(record))
        refusal = ''
        for start in (None, *known[::-1]):
            try:
                steady = steady_state(model, haul.warp_m, haul.speed, start=start)
            except NoSteadyState as reason:
                refusal = refusal or str(reason)
                continue
            known.append(steady.equilibrium)
            derived = quantities(model, steady)
            results.append(ModelledHaul(gear, haul, steady.observables, derived=derived))
            break
        else:
            results.append(ModelledHaul(gear, haul, None, refusal))
    return results


Modelled = Mapping[tuple[str, str], ModelledHaul]
"""Hauls by gear and name."""


def is_right(trend: TrendRecord, hauls: Modelled) -> bool:
    """True if the model changes by the sign or bound; False without both steady states."""
    first, second = _ends(trend, hauls)
    if trend.within is not None:
        return bool(abs(second - first) <= trend.within)
    assert trend.sign is not None
    return bool(trend.sign * (second - first) > 0.0)


def modelled_trend(trend: TrendRecord, hauls: Modelled) -> float:
    """Ratio or slope of the model where the source prints one; NaN without both steady states."""
    first, second = _ends(trend, hauls)
    if trend.per is None:
        return second / first
    start, end = (
        getattr(hauls[trend.gear, name].haul, trend.per) for name in (trend.first, trend.second)
    )
    return float((second - first) / (end - start))


def _ends(trend: TrendRecord, hauls: Modelled) -> tuple[float, float]:
    first, second = (
        hauls[trend.gear, name].value(trend.quantity) for name in (trend.first, trend.second)
    )
    return first, second
