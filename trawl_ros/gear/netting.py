# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Records of the netting: its sections or its plan, and its numerical mesh."""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from trawl_ros.core.schema import Record
from trawl_ros.gear.net_plan import NetPlanRecord
from trawl_ros.gear.numbers import Length, Mesh, NotNegative, Positive


class SectionRecord(Record):
    """Section of netting, from front to back.

    ``ropes`` of a plan have no meshes; ``mesh_m`` is the circumference at the mouth per rope.
    """

    name: str
    """Name in messages."""
    length_m: Length
    """Stretched length."""
    front_circumference_m: Length
    """Stretched circumference at its front."""
    back_circumference_m: Length
    """The same at its back; it tapers evenly."""
    mesh_m: Mesh
    """Stretched mesh."""
    twine_diameter_m: Annotated[float, Field(gt=0, le=0.1)]
    """Diameter of the twine."""
    twine_density_kg_m3: Annotated[float, Field(ge=500, le=8000)]
    """Density of its fibres."""
    twine_modulus_pa: Positive
    """Modulus of the twine."""
    twines: Literal[1, 2] = 1
    """Twines in each bar."""
    knotless: bool = False
    """True without knots."""
    shielding: Annotated[float, Field(gt=0, le=1)] | None = None
    """Drag over that of single twines; default by the wake."""
    mesh_angle_deg: Annotated[float, Field(gt=0, lt=90)] | None = None
    """Angle of the bars to the flow, in a codend."""
    square: bool = False
    """True for square meshes, in a codend."""
    ropes: bool = False
    """True for ropes in place of meshes; only a plan has them."""


class NettingRecord(Record):
    """Net: sections of diamond mesh and a codend, or a plan, and their numerical mesh.

    With a ``plan``, sections, codend and wings are those of its pieces.

    ``around`` numerical meshes stand for the real meshes of every row; the length of a numerical
    row keeps the angle of the meshes. Sections of the ``body`` become netting, those of the
    ``codend`` one line. Drag coefficients are those at high Reynolds numbers
    (`trawl_ros.model.net.wake`); their defaults agree with measured panels (config/panels).
    """

    around: Annotated[int, Field(ge=12, le=240, multiple_of=12)]
    """Numerical meshes around the mouth, a multiple of 12; fewer are faster."""
    halved_at_circumference_m: Annotated[tuple[Positive, ...], Field(max_length=4)] = ()
    """Behind each of these, half as many go around."""
    body: Annotated[tuple[SectionRecord, ...], Field(max_length=30)] = ()
    """Sections of the net, unless there is a plan."""
    codend: Annotated[tuple[SectionRecord, ...], Field(max_length=10)] = ()
    """Sections of the codend, unless there is a plan."""
    plan: NetPlanRecord | None = None
    """Net plan."""
    codend_segments: Annotated[int, Field(ge=2, le=100)]
    """Numerical bars of the codend, which is one line."""
    codend_mesh_angle_deg: Annotated[float, Field(gt=0, lt=90)]
    """Angle of the bars of the codend to the flow."""
    damping_time_s: NotNegative
    """Inner damping, as for ropes."""
    normal_drag: NotNegative = 0.9
    """C_N of twine across the flow."""
    friction: NotNegative = 0.02
    """C_f along a twine."""
    viscous: NotNegative = 1.0
    """Factor on the viscous parts of both."""
    added_mass_normal: NotNegative
    """Added mass across, over that of the displaced water."""
    knot_diameters: NotNegative
    """Diameter of a knot over that of its twine."""
    knot_drag: NotNegative = 1.2
    """C_D of knots."""
    wake_exchange: NotNegative = 0.03
    """Turbulent exchange e through a sheet."""
    lift: NotNegative = 3.0
    """Lift of sheets, per square of their solidity."""
    knot_added_mass: NotNegative
    """Added mass of knots, over that of the displaced water."""
    wing_end_m: Positive | None = None
    """Length of the line from upper to lower wing tip, without a plan."""
    wing_edge_hanging: Annotated[float, Field(gt=0.3, lt=1)] | None = None
    """Rope over stretched netting along the edges of the wings, without a plan."""
    bowing_pressure_pa: NotNegative = 0.0
    """Load across twine under which it bows; 0 for straight bars."""

    @model_validator(mode='after')
    def _one_form(self) -> 'NettingRecord':
        outline = {
            'body': self.body or None,
            'codend': self.codend or None,
            'wing_end_m': self.wing_end_m,
            'wing_edge_hanging': self.wing_edge_hanging,
        }
        for key, value in outline.items():
            if self.plan is None and value is None:
                raise ValueError(f'{key}: missing, expected this key or a plan')
            if self.plan is not None and value is not None:
                raise ValueError(f'{key}: found together with a plan, expected one of them')
        if any(section.ropes for section in (*self.body, *self.codend)):
            raise ValueError('body: found ropes, expected them only in a plan')
        return self
