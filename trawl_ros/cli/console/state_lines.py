# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Lines that describe a state of the gear, in the units of a user."""

from typing import TYPE_CHECKING

import numpy as np

from trawl_ros.core.display_units import DisplayUnits

if TYPE_CHECKING:
    from trawl_ros.records.observables import Observables


def state_lines(seen: 'Observables', units: DisplayUnits, *, paired: bool) -> tuple[str, ...]:
    """Describe doors, mouth and tension; a pair trawl (``paired``) has no doors."""
    doors = (
        f'α {np.degrees(seen.port_attack):.1f}°, δ {np.degrees(seen.port_inclination):.1f}°, '
        f'doors {units.shown(seen.door_spread, "width")} apart and '
        f'{units.shown(seen.door_depth, "depth")} deep'
    )
    return (
        *(() if paired else (doors,)),
        f'mouth {units.shown(seen.vertical_opening, "width")} high and '
        f'{units.shown(seen.horizontal_opening, "width")} wide, '
        f'headrope {units.shown(seen.net_depth, "depth")} deep',
        f'{units.shown(seen.warp_tension, "tension")} on a warp',
    )
