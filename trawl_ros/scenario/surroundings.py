"""The water around instruments, from the gear file's."""

from trawl_ros.gear.records import GearRecord
from trawl_ros.instruments.surroundings import Surroundings
from trawl_ros.model.gear_model import build_water


def build_surroundings(gear: GearRecord) -> Surroundings:
    """Make what instruments know of the water that a gear file describes."""
    return Surroundings(
        build_water(gear).pressure,
        tuple((level.depth_m, level.temperature_deg_c) for level in gear.water.temperature),
        gear.water.salinity_g_kg,
    )
