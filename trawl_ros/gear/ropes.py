"""Records of ropes by their make: warps, bridles, and ropes of the frame."""

from typing import Annotated

from pydantic import Field

from trawl_ros.core.schema import Record
from trawl_ros.gear.numbers import NotNegative, Positive


class RopeRecord(Record):
    """Rope of one make; ``segments`` is the number of numerical bars it is cut into."""

    diameter_m: Annotated[float, Field(gt=0, le=0.5)]
    weight_in_water_n_m: float
    stiffness_n: Positive
    damping_time_s: NotNegative
    normal_drag: NotNegative
    tangential_drag: NotNegative
    added_mass_normal: NotNegative
    added_mass_tangential: NotNegative


class WarpRecord(RopeRecord):
    """Warp; its length is commanded to the winch."""

    segments: Annotated[int, Field(ge=2, le=500)]


class BridleRecord(RopeRecord):
    """A bridle from a board to a wing tip."""

    length_m: Positive
    segments: Annotated[int, Field(ge=2, le=200)]


class FrameRopeRecord(RopeRecord):
    """Rope of the frame, from wing tip to wing tip.

    Without a length it is as long as the hanging ratios of the net plan make it.
    """

    length_m: Positive | None = None
