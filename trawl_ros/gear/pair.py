"""Records of a pair trawl: two ships, and the plates at which warps and bridles meet."""

from typing import Annotated

from pydantic import Field

from trawl_ros.core.schema import Record
from trawl_ros.gear.boards import BoardRecord, CoefficientsRecord, FasteningRecord, plate_inertia
from trawl_ros.records.coefficients import COEFFICIENTS

STEEL = 7850.0
"""Density (kg/m³) of the plate and its shackles."""

AHEAD, ASTERN, UP = 0.3, -0.2, 0.25
"""Holes of the plate (m from its middle): the warp's ahead, the bridles' astern, above and below;
assumed."""


class PairRecord(Record):
    """Two ships that tow one net between them, abreast and ``distance_m`` apart, without boards.

    ``plate_mass_kg`` is that of the triangular plate with its shackles in which the warp of either
    ship ends and the bridles begin. Its drag is left out.
    """

    distance_m: Annotated[float, Field(gt=10, le=2000)]
    plate_mass_kg: Annotated[float, Field(gt=1, le=5000)] = 60.0


def towing_plate(pair: PairRecord) -> BoardRecord:
    """The plate as a body that takes the place of a board and that the water does not push."""
    long, high = AHEAD - ASTERN, 2 * UP
    volume = pair.plate_mass_kg / STEEL
    return BoardRecord.model_validate(
        {
            'mass_kg': pair.plate_mass_kg,
            'volume_m3': volume,
            'inertia': plate_inertia(pair.plate_mass_kg, volume, high, long),
            # So small that corrections to its coefficients, all zero, would not be felt.
            'area_m2': 1e-6,
            'span_m': high,
            'chord_m': long,
            'coefficients': CoefficientsRecord(**dict.fromkeys(COEFFICIENTS, 0.0)),
            'rotary_slope': 0.0,
            'fastening': FasteningRecord(
                warp_m=(AHEAD, 0.0, 0.0),
                upper_bridle_m=(ASTERN, 0.0, UP),
                lower_bridle_m=(ASTERN, 0.0, -UP),
            ),
        }
    )
