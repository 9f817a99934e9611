"""Water around the instruments, from the gear file's."""

from trawl_ros.gear.records import GearRecord
from trawl_ros.instruments.surroundings import Surroundings
from trawl_ros.model.gear_model import build_water


def build_surroundings(gear: GearRecord) -> Surroundings:
    """Build the instruments' record of the water in a gear file."""
    return Surroundings(
        build_water(gear).pressure,
        tuple((level.depth_m, level.temperature_deg_c) for level in gear.water.temperature),
        gear.water.salinity_g_kg,
    )
