"""Kinds of numbers in records of a gear file."""

from typing import Annotated

from pydantic import Field

Positive = Annotated[float, Field(gt=0)]
NotNegative = Annotated[float, Field(ge=0)]
Coefficient = Annotated[float, Field(ge=-10, le=10)]
Degrees = Annotated[float, Field(ge=-60, le=60)]
Share = Annotated[float, Field(ge=0, le=1)]
Vector = tuple[float, float, float]
