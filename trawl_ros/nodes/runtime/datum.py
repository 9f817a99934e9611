# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Parameters of the datum: where on Earth the origin of ``map`` is."""

from trawl_ros.instruments.parameters import VesselParameters
from trawl_ros.nodes.runtime.parameters import Number, Spec


def datum_specs(record: VesselParameters) -> tuple[Spec, ...]:
    """Return the parameters; their defaults are those of the instruments."""
    return (
        Number('datum_lat', record.datum_lat_deg, 'deg', -89.0, 89.0,
               'Latitude of the origin of map; by default that of the instruments.'),
        Number('datum_lon', record.datum_lon_deg, 'deg', -180.0, 180.0,
               'Longitude of the origin of map; by default that of the instruments.'),
    )  # fmt: skip
