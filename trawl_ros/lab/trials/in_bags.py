"""Trials as full bags: of one steady state after the other, or of tows in time."""

from dataclasses import replace
from pathlib import Path

from trawl_ros.core.errors import NoSteadyState
from trawl_ros.lab.trials.course import Course, quasi_steady
from trawl_ros.lab.trials.linearised_plant import MeshResolution
from trawl_ros.lab.trials.making import DROPOUTS, SeededTrial, chance_of, hide
from trawl_ros.lab.trials.recording import record_tows
from trawl_ros.lab.trials.towing import towed_in_time
from trawl_ros.lab.trials.tows import PLANS
from trawl_ros.lab.trials.trial import Key, Spec
from trawl_ros.solver.stepper import StepFailed


def make_bags(spec: Spec, gear: str, cut: MeshResolution, seed: int, folder: Path) -> Key:
    """Make a trial as bags in a folder, unless what is hidden is not possible."""
    hiding = hide(spec, gear, cut, seed)
    if not hiding.key.testable:
        return hiding.key
    try:
        courses = _in_time(hiding) if spec.form == 'dynamic' else _steady(hiding)
    except (NoSteadyState, StepFailed) as reason:
        return replace(hiding.key, testable=False, why_not=f'cannot be towed: {reason}')
    chance = chance_of(spec, seed, spec.form)
    record_tows(folder, courses, hiding.plant.model.water, hiding.sensors, DROPOUTS, chance)
    return hiding.key


def _steady(hiding: SeededTrial) -> list[Course]:
    plan = PLANS[hiding.key.spec.plan]
    tows = hiding.plant.towed(hiding.effects, plan)
    return [quasi_steady(tow, looks) for tow, looks in zip(plan.tows, tows, strict=True)]


def _in_time(hiding: SeededTrial) -> list[Course]:
    plan = PLANS[hiding.key.spec.plan]
    return [
        towed_in_time(hiding.plant.model, tow, () if number < plan.baseline else hiding.effects)
        for number, tow in enumerate(plan.tows)
    ]
