"""Trials that are towed on as a diagnosis proposed."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.lab.trials.linearised_plant import MeshResolution
from trawl_ros.lab.trials.making import chance_of, hide, windows_of
from trawl_ros.lab.trials.tows import BlindTrialPlan, PlannedTow
from trawl_ros.lab.trials.trial import Key, Spec

SERIES = 'followed'


def proposed(diagnosis: Mapping[str, Any]) -> PlannedTow | None:
    """Next tow by a diagnosis; None where it proposes none."""
    for step in diagnosis['next_tow']:
        if step['states']:
            states = tuple((state['warp_length'], state['speed']) for state in step['states'])
            return PlannedTow(states, eastward=not step['reciprocal'])
    return None


def tow_on(
    spec: Spec,
    gear: str,
    cut: MeshResolution,
    seed: int,
    windows: Sequence[SteadyWindow],
    tow: PlannedTow,
) -> tuple[Key, tuple[SteadyWindow, ...] | None]:
    """Add a tow to the windows of a trial, or say in the key why it cannot be towed."""
    hiding = hide(spec, gear, cut, seed)
    key = replace(hiding.key, spec=replace(spec, series=SERIES))
    plan = BlindTrialPlan((tow,), baseline=0)
    towed = hiding.towed(plan)
    if towed is None:
        return replace(key, testable=False, why_not='cannot be towed'), None
    more, _ = windows_of(
        towed,
        chance_of(spec, seed, SERIES),
        plan,
        hiding.sensors,
        first=len(windows),
        first_tow=1 + max(window.tow for window in windows),
    )
    return key, (*windows, *more)
