"""Records of ropes by their make: warps, bridles, and ropes of the frame."""

from typing import Annotated

from pydantic import Field

from trawl_ros.core.schema import Record
from trawl_ros.gear.numbers import Damping, Drag, Length, Stiffness, Weight


class RopeRecord(Record):
    """Rope of one make; ``segments`` is the number of numerical bars it is cut into."""

    diameter_m: Annotated[float, Field(gt=0, le=0.5)]
    weight_in_water_n_m: Weight
    stiffness_n: Stiffness
    damping_time_s: Damping
    normal_drag: Drag
    tangential_drag: Drag
    added_mass_normal: Drag
    added_mass_tangential: Drag


class WarpRecord(RopeRecord):
    """Warp; its length is commanded to the winch."""

    segments: Annotated[int, Field(ge=2, le=500)]


class BridleRecord(RopeRecord):
    """A bridle from a board to a wing tip."""

    length_m: Length
    segments: Annotated[int, Field(ge=2, le=200)]


class FrameRopeRecord(RopeRecord):
    """Rope of the frame, from wing tip to wing tip.

    Without a length it is as long as the hanging ratios of the net plan make it.
    """

    length_m: Length | None = None
