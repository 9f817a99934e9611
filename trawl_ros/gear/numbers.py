"""Kinds of numbers in records of a gear file, bounded by more than any gear has."""

from typing import Annotated

from pydantic import Field

Positive = Annotated[float, Field(gt=0, le=1e12)]
NotNegative = Annotated[float, Field(ge=0, le=1e9)]
Length = Annotated[float, Field(gt=0, le=3000)]
"""Of a rope or a section of netting, m."""
Share = Annotated[float, Field(ge=0, le=1)]
Coefficient = Annotated[float, Field(ge=-10, le=10)]
Drag = Annotated[float, Field(ge=0, le=10)]
"""Coefficients of drag and added mass."""
Stiffness = Annotated[float, Field(ge=1e3, le=1e10)]
"""EA of a rope, N: that of steel wire of 0.5 m is 1e10."""
Weight = Annotated[float, Field(ge=-1000, le=10_000)]
"""In water per length, N/m; negative for ropes that float."""
Damping = Annotated[float, Field(ge=0, le=100)]
"""Time in which a bar's own motion dies out, s."""
Mesh = Annotated[float, Field(ge=0.002, le=200)]
"""Stretched mesh, m."""
Degrees = Annotated[float, Field(ge=-60, le=60)]
Vector = tuple[
    Annotated[float, Field(ge=-100, le=100)],
    Annotated[float, Field(ge=-100, le=100)],
    Annotated[float, Field(ge=-100, le=100)],
]
