# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Records of the netting: its sections or its plan, and its numerical mesh."""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from trawl_ros.core.schema import Record
from trawl_ros.gear.net_plan import NetPlanRecord
from trawl_ros.gear.numbers import Length, Mesh, NotNegative, Positive


class SectionRecord(Record):
    """Section of netting, from front to back; its stretched circumference tapers linearly.

    ``shielding`` is the drag in this netting over that of single twines; by default it is that of
    `trawl_ros.model.net.wake`. ``twines`` is the number of twines side by side in each bar. Bars of
    a codend may have their own ``mesh_angle_deg``, or lie along and across the flow (``square``).
    ``ropes`` of a plan have no meshes; ``mesh_m`` is the circumference at the mouth per rope.
    """

    name: str
    length_m: Length
    front_circumference_m: Length
    back_circumference_m: Length
    mesh_m: Mesh
    twine_diameter_m: Annotated[float, Field(gt=0, le=0.1)]
    twine_density_kg_m3: Annotated[float, Field(ge=500, le=8000)]
    twine_modulus_pa: Positive
    twines: Literal[1, 2] = 1
    knotless: bool = False
    shielding: Annotated[float, Field(gt=0, le=1)] | None = None
    mesh_angle_deg: Annotated[float, Field(gt=0, lt=90)] | None = None
    square: bool = False
    ropes: bool = False


class NettingRecord(Record):
    """Net: sections of diamond mesh and a codend, or a plan, and their numerical mesh.

    With a ``plan``, sections, codend and wings are those of its pieces.

    ``around`` numerical meshes stand for the real meshes of every row; the length of a numerical
    row keeps the angle of the meshes. ``body`` sections become netting. The ``codend`` sections
    become one line of ``codend_segments`` with the drag of their twine at the stated angle. Behind
    each stretched circumference of ``halved_at_circumference_m`` the number of numerical meshes
    around is halved. ``bowing_pressure_pa`` is the load of the water across twine, per projected
    area, under which it sags between its knots; without it bars are straight.

    ``normal_drag`` (eq. 23), ``friction`` (eq. 24) and ``knot_drag`` are the coefficients at high
    Reynolds numbers. ``viscous`` is a factor on their increase at low Reynolds numbers,
    ``wake_exchange`` the exchange of water along a sheet with the water outside, and ``lift`` the
    lift of sheets per square of their solidity (`trawl_ros.model.net.wake`). Defaults agree with
    measured panels (config/panels).
    """

    around: Annotated[int, Field(ge=12, le=240, multiple_of=12)]
    halved_at_circumference_m: Annotated[tuple[Positive, ...], Field(max_length=4)] = ()
    body: Annotated[tuple[SectionRecord, ...], Field(max_length=30)] = ()
    codend: Annotated[tuple[SectionRecord, ...], Field(max_length=10)] = ()
    plan: NetPlanRecord | None = None
    codend_segments: Annotated[int, Field(ge=2, le=100)]
    codend_mesh_angle_deg: Annotated[float, Field(gt=0, lt=90)]
    damping_time_s: NotNegative
    normal_drag: NotNegative = 0.9
    friction: NotNegative = 0.02
    viscous: NotNegative = 1.0
    added_mass_normal: NotNegative
    knot_diameters: NotNegative
    knot_drag: NotNegative = 1.2
    wake_exchange: NotNegative = 0.03
    lift: NotNegative = 3.0
    knot_added_mass: NotNegative
    wing_end_m: Positive | None = None
    wing_edge_hanging: Annotated[float, Field(gt=0.3, lt=1)] | None = None
    bowing_pressure_pa: NotNegative = 0.0

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
