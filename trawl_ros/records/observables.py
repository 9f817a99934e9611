# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Observables of a gear: depths, spreads, openings, warp tensions and board angles."""

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Observables:
    """Observables of one state; lengths in m, tensions in N, angles in rad.

    ``net_depth`` is that of the headrope's centre; ``vertical_opening`` is headrope above
    footrope at the centre, ``horizontal_opening`` the distance between the upper wing tips.
    Tension, ``divergence`` (outward positive, against the ship's course) and ``declination``
    (down positive) belong to the warp at its block. ``pitch`` is nose down and ``roll`` top to
    starboard positive in the door frame; ``attack``, ``slip``, ``inclination`` are α, β, δ.
    ``slant_range`` is the distance of a door from the middle between the towing blocks, m.

    Examples
    --------
    >>> import trawl_ros
    >>> model = trawl_ros.build_model(trawl_ros.load_gear('kaifuha').refined(net=0.25))
    >>> seen = trawl_ros.steady_state(model, 500.0, 2.1).observables
    >>> round(seen.warp_tension / 1000), seen.array().shape
    (147, (24,))
    """

    door_spread: float
    port_door_depth: float
    starboard_door_depth: float
    port_tension: float
    starboard_tension: float
    net_depth: float
    vertical_opening: float
    horizontal_opening: float
    port_pitch: float
    starboard_pitch: float
    port_roll: float
    starboard_roll: float
    port_divergence: float
    starboard_divergence: float
    port_declination: float
    starboard_declination: float
    port_attack: float
    starboard_attack: float
    port_slip: float
    starboard_slip: float
    port_inclination: float
    starboard_inclination: float
    port_slant_range: float
    starboard_slant_range: float

    def array(self) -> NDArray[np.float64]:
        """All observables (n_observables,) in the order of `OBSERVABLES`."""
        return np.array([getattr(self, name) for name in OBSERVABLES])

    @property
    def door_depth(self) -> float:
        """Mean depth of both doors, m."""
        return 0.5 * (self.port_door_depth + self.starboard_door_depth)

    @property
    def warp_tension(self) -> float:
        """Mean tension of both warps at the block, N."""
        return 0.5 * (self.port_tension + self.starboard_tension)


OBSERVABLES = tuple(field.name for field in fields(Observables))
"""Names of the observables, in order."""
