# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Kinds of numbers in records of a gear file, with bounds wider than any gear needs."""

from typing import Annotated

from pydantic import Field

Positive = Annotated[float, Field(gt=0, le=1e12)]
NotNegative = Annotated[float, Field(ge=0, le=1e9)]
Length = Annotated[float, Field(gt=0, le=3000)]
"""Length of a rope or a section of netting, m."""
Share = Annotated[float, Field(ge=0, le=1)]
Coefficient = Annotated[float, Field(ge=-10, le=10)]
Drag = Annotated[float, Field(ge=0, le=10)]
"""Coefficients of drag and added mass."""
Stiffness = Annotated[float, Field(ge=1e3, le=1e10)]
"""EA of a rope, N; a steel wire of 0.5 m diameter has 1e10."""
Weight = Annotated[float, Field(ge=-1000, le=10_000)]
"""Weight in water per length, N/m; negative for ropes that float."""
Damping = Annotated[float, Field(ge=0, le=100)]
"""Time in which a bar's longitudinal vibration dies out, s."""
Mesh = Annotated[float, Field(ge=0.002, le=200)]
"""Stretched mesh, m."""
Degrees = Annotated[float, Field(ge=-60, le=60)]
Vector = tuple[
    Annotated[float, Field(ge=-100, le=100)],
    Annotated[float, Field(ge=-100, le=100)],
    Annotated[float, Field(ge=-100, le=100)],
]
