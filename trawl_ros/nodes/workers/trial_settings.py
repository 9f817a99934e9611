# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Parameters of a trial in its node, which loads no numerics."""

import math

from trawl_ros.control.trial.records import TrialSettings
from trawl_ros.gear.records import GearRecord
from trawl_ros.nodes.runtime.parameters import Number, Parameters, Text
from trawl_ros.records.towing_limits import LIMITS

TRIAL = TrialSettings()
QUANTITIES = 12

TRIAL_SPECS = (
    Text('gear', 'kaifuha', 'Gear file, or the name of one that comes with the package: its ship, '
         'winches and water.'),
    Text('state', '', 'File that takes the state of the trial, and from which a node that is '
         'started again goes on; none if empty.'),
    Number('hours', TRIAL.hours, 'h', 0.05, 240.0, 'Time for the trial, all waiting counted.',
           live=True),
    Number('wanted_percent', 100 * TRIAL.wanted_share, '%', 0.1, 100.0, 'A quantity of the '
           "boards' laws is known when its std is below this part of its span.", live=True),
    Number('wanted_known', TRIAL.wanted_known, 'quantities', 1, QUANTITIES, 'The trial ends when '
           'so many are known.', whole=True, live=True),
    Number('max_tension_kn', 0.0, 'kN', 0.0, 2000.0, 'Highest tension of a warp; 0 is no limit.',
           live=True),
    Number('max_depth_m', 0.0, 'm', 0.0, 3000.0, 'Greatest depth of the gear; 0 is no limit.',
           live=True),
    Number('seabed_m', 0.0, 'm', 0.0, 6000.0, 'Depth of the water, where it is less than the echo '
           'sounder says; 0 is what the sounder says.', live=True),
    Number('clearance_m', TRIAL.clearance, 'm', 0.0, 500.0, 'Least distance of the gear from the '
           'seabed.', live=True),
    Number('max_turn_deg_s', math.degrees(TRIAL.max_turn), 'deg/s', 0.01, 3.0, 'Fastest rate of '
           'turn with which the heading is kept; it holds while the ship turns twice as fast.',
           live=True),
    Number('winch_speed_m_s', 0.0, 'm/s', 0.0, 3.0, 'Fastest the warps are moved; 0 is what the '
           'gear file says.', live=True),
    Number('least_speed_m_s', TRIAL.least_speed, 'm/s', *LIMITS.speed_m_s,
           'Slowest the gear is to go through the water, also while warp runs out.', live=True),
    Number('most_speed_m_s', TRIAL.most_speed, 'm/s', *LIMITS.speed_m_s,
           'Fastest the ship is to go.', live=True),
    Number('stale_s', TRIAL.stale, 's', 0.2, 60.0, 'Age at which a reading is stale; one that '
           'comes seldom, at one and a half of its periods.', live=True),
)  # fmt: skip


def trial_settings(parameters: Parameters, gear: GearRecord) -> TrialSettings:
    """Return the settings of a node that declares `TRIAL_SPECS`."""
    return TrialSettings(
        hours=parameters['hours'],
        wanted_share=0.01 * parameters['wanted_percent'],
        wanted_known=parameters['wanted_known'],
        max_tension=1e3 * parameters['max_tension_kn'] or math.inf,
        max_depth=parameters['max_depth_m'] or math.inf,
        seabed=parameters['seabed_m'] or math.inf,
        clearance=parameters['clearance_m'],
        max_turn=math.radians(parameters['max_turn_deg_s']),
        winch_speed=parameters['winch_speed_m_s'] or gear.winch.max_speed_m_s,
        ship_acceleration=gear.ship.max_acceleration_m_s2,
        least_speed=parameters['least_speed_m_s'],
        most_speed=parameters['most_speed_m_s'],
        stale=parameters['stale_s'],
    )
