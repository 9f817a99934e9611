# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Scenario file of a plan, for ``trawl tow``."""

from trawl_ros.estimation.planning.states import Manoeuvre
from trawl_ros.estimation.planning.sweep import SweepTrial


def scenario_of(trial: SweepTrial, gear: str) -> dict[str, object]:
    """Return the content of the scenario file, to be written as YAML.

    Parameters
    ----------
    trial
        Its first leg is where the scenario starts.
    gear
        As the file is to name it.
    """
    steps = []
    for number, leg in enumerate(trial.legs, 1):
        lengths = _lengths(leg.manoeuvre)
        if leg.veering_minutes:
            steps.append(
                {
                    'name': f'{number}: on the way, at {leg.veering_speed:g} m/s',
                    'minutes': leg.veering_minutes,
                    **lengths,
                    'speed_m_s': leg.veering_speed,
                }
            )
        steps.append(
            {
                'name': f'{number}: {leg.manoeuvre}',
                'minutes': leg.minutes,
                **lengths,
                'speed_m_s': leg.manoeuvre.speed,
            }
        )
    first = trial.legs[0].manoeuvre
    return {
        'description': f'A planned trial of {len(trial.legs)} steady states in '
        f'{trial.minutes / 60.0:.1f} h',
        'gear': gear,
        'heading_deg': 90.0,
        'start': {**_lengths(first), 'speed_m_s': first.speed},
        'steps': steps,
        'truth_rate_hz': 2.0,
        'record': ['instruments', 'truth'],
    }


def _lengths(manoeuvre: Manoeuvre) -> dict[str, float]:
    if manoeuvre.equal:
        return {'warp_length_m': manoeuvre.port_length}
    return {
        'port_warp_length_m': manoeuvre.port_length,
        'starboard_warp_length_m': manoeuvre.starboard_length,
    }
