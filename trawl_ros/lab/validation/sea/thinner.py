"""Nets with less twine behind, as where a liner is taken out."""

from typing import Annotated

from pydantic import Field

from trawl_ros.core.errors import TrawlError
from trawl_ros.core.schema import Record
from trawl_ros.gear.net_plan import NetPlanRecord, PieceRecord


class ThinnerRecord(Record):
    """Share of the net's twine area that is taken off its small meshes, by thinner twine."""

    mesh_up_to_mm: Annotated[float, Field(gt=0)]
    area_off: Annotated[float, Field(gt=0, lt=1)]


def thinner(plan: NetPlanRecord, change: ThinnerRecord) -> NetPlanRecord:
    """Plan with thinner twine in all pieces of meshes up to a size.

    Raises
    ------
    TrawlError
        If these pieces have less twine than is to be taken off.
    """
    small = [piece for piece in plan.pieces if piece.mesh_mm <= change.mesh_up_to_mm]
    share = sum(piece.twine_area for piece in small) / sum(
        piece.twine_area for piece in plan.pieces
    )
    if share <= change.area_off:
        raise TrawlError(
            f'thinner.area_off: found {change.area_off:g}, expected less than {share:.3g}, the '
            f'share of the twine area in meshes up to {change.mesh_up_to_mm:g} mm'
        )
    factor = 1.0 - change.area_off / share
    pieces = tuple(_thinned(piece, factor) if piece in small else piece for piece in plan.pieces)
    return plan.model_copy(update={'pieces': pieces})


def _thinned(piece: PieceRecord, factor: float) -> PieceRecord:
    """Piece with another diameter of twine; its mass per length goes with the square."""
    changed = {}
    if piece.rtex is not None:
        changed['rtex'] = factor**2 * piece.rtex
    if piece.twine_diameter_mm is not None:
        changed['twine_diameter_mm'] = factor * piece.twine_diameter_mm
    return piece.model_copy(update=changed)
