# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Files of a plan: JSON, scenario and figure."""

import math
from pathlib import Path

import yaml

from trawl_ros.core.files import finite, made_folder, write_figure, write_json, write_text
from trawl_ros.estimation.fit.laws import QUANTITIES, LawQuantities
from trawl_ros.estimation.planning.figure import plan_figure
from trawl_ros.estimation.planning.plan import TrialPlan
from trawl_ros.estimation.planning.scenario import scenario_of
from trawl_ros.estimation.planning.states import Manoeuvre
from trawl_ros.estimation.planning.sweep import SweepTrial
from trawl_ros.report.style import DPI
from trawl_ros.scenario.scenario import load_scenario

PLAN, SCENARIO, PICTURE = 'plan.json', 'trial.yaml', 'plan.png'


def write_plan(plan: TrialPlan, gear: str, folder: Path) -> None:
    """Write ``plan.json``, ``trial.yaml`` and ``plan.png``.

    Parameters
    ----------
    plan
        The plan of the trial.
    gear
        The gear as the user named it: the name of one that comes with the package, or a file,
        which is copied beside the scenario so that this can be moved.
    folder
        Made if need be.

    Raises
    ------
    TrawlError
        If the folder cannot be written to.
    """
    made_folder(folder)
    write_json(folder / PLAN, plan_record(plan), indent=2)
    named = gear
    if Path(gear).is_file():
        named = f'{Path(gear).stem}.yaml'
        if not (folder / named).exists() or not Path(gear).samefile(folder / named):
            write_text(folder / named, Path(gear).read_text(encoding='utf-8'))
    record = scenario_of(plan.trial, named)
    lines = yaml.safe_dump(record, sort_keys=False, allow_unicode=True, width=100)
    write_text(folder / SCENARIO, lines)
    write_figure(folder / PICTURE, plan_figure(plan), DPI)
    load_scenario(folder / SCENARIO)


def plan_record(plan: TrialPlan) -> dict[str, object]:
    """Plan as JSON content; lengths in m, speeds in m/s, times in minutes."""
    return {
        'gear': plan.gear,
        'minutes': plan.trial.minutes,
        'budget_minutes': plan.problem.minutes,
        'working_angles_deg': {
            'attack': math.degrees(plan.problem.angles.attack),
            'slip': math.degrees(plan.problem.angles.slip),
        },
        'legs': [
            {
                **_manoeuvre(leg.manoeuvre),
                'minutes': leg.total_minutes,
                'well_known_after': gain.well_known,
                'helps_most': gain.quantity,
                'sd_of_span_before': gain.before,
                'sd_of_span_after': gain.after,
            }
            for leg, gain in zip(plan.trial.legs, plan.gains, strict=True)
        ],
        'quantities': {
            name: {
                'sd_of_span_before': finite(plan.before.ratio[index]),
                **{
                    _key(trial): finite(trial.known.ratio[index])
                    for trial in (plan.trial, *plan.sweeps)
                },
                'well_known': bool(plan.trial.known.well_known[index]),
                **{
                    f'sd_of_span_after_plan_by_{part}': finite(known.ratio[index])
                    for part, known in _in_motion(plan).items()
                },
                'limited_by': plan.limits.get(name),
            }
            for index, name in enumerate(QUANTITIES)
        },
        **{
            f'well_known_by_{part}': int(known.well_known.sum())
            for part, known in _in_motion(plan).items()
        },
        'minutes_left_out': None if plan.in_motion is None else plan.in_motion.left_out_minutes,
        'windows_only': plan.windows_only or None,
        'trials': [_trial(trial) for trial in (plan.trial, *plan.sweeps)],
        'refused': [
            {**_manoeuvre(refused.manoeuvre), 'reason': refused.reason}
            for refused in plan.choice.refused
        ],
    }


def _in_motion(plan: TrialPlan) -> dict[str, LawQuantities]:
    known = plan.in_motion
    return {} if known is None else {'steady_parts': known.steady, 'whole_tow': known.whole}


def _key(trial: SweepTrial) -> str:
    return f'sd_of_span_after_{trial.name}'.replace(', ', '_').replace("'s", '').replace(' ', '_')


def _trial(trial: SweepTrial) -> dict[str, object]:
    def number(known: LawQuantities) -> int:
        return int(known.well_known.sum())

    return {
        'name': trial.name,
        'legs': len(trial.legs),
        'minutes': trial.minutes,
        'well_known': number(trial.known),
        'well_known_by_data_alone': number(trial.by_data),
        'well_known_with_the_board_of_the_file': number(trial.as_filed),
    }


def _manoeuvre(manoeuvre: Manoeuvre) -> dict[str, float]:
    return {
        'port_length': manoeuvre.port_length,
        'starboard_length': manoeuvre.starboard_length,
        'speed': manoeuvre.speed,
    }
