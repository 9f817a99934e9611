# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Records of a blind case: its specification, its key, and its diagnosis."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any, Literal

import numpy as np

Form = Literal['windows', 'bags', 'dynamic']


@dataclass(frozen=True)
class Spec:
    """Specification of a trial.

    Attributes
    ----------
    series
        'clean', 'inside', 'outside', 'pair', 'triple', 'poor', 'deck' or 'sea', and 'followed' of
        one that was towed on.
    number
        Within the study.
    effects
        Names of what is hidden.
    strength
        In smallest detectable sizes.
    signs
        To which sides.
    plant
        Number of the plant.
    plan
        Name of one of `PLANS`.
    form
        Input of the diagnosis: windows worked out from steady states, or bags of one steady state
        after the other, or of tows in time.
    like
        Number of the trial in which the same is hidden, where there is one.
    """

    series: str
    number: int
    effects: tuple[str, ...]
    strength: float
    signs: tuple[float, ...]
    plant: int
    plan: str = 'full'
    form: Form = 'windows'
    like: int | None = None

    @property
    def origin(self) -> int:
        """Number of the trial with the same draws."""
        return self.number if self.like is None else self.like


@dataclass(frozen=True)
class Key:
    """Key of a case: its hidden effects, ``testable`` or not; only the scorer reads it.

    ``floor`` are the plant's own errors by channel, on the windows held out of the fit.
    """

    spec: Spec
    sizes: tuple[float, ...]
    units: tuple[str, ...]
    detectable: tuple[float, ...]
    testable: bool
    why_not: str
    coefficients: tuple[float, ...]
    floor: Mapping[str, float]

    def record(self) -> dict[str, Any]:
        """Return it as plain values; infinite sizes are null."""
        record = asdict(self)
        for name in ('sizes', 'detectable'):
            record[name] = [value if np.isfinite(value) else None for value in record[name]]
        return record


@dataclass(frozen=True)
class Scored:
    """Scored trial: its key and its diagnosis, None without one.

    Attributes
    ----------
    key
        As `Key.record` has it.
    diagnosis
        ``diagnosis.json``; None where the trial is not testable.
    quiet
        Best fit of readings without errors, the right effect among it; only of some
        of the trials in which it was named.
    """

    key: dict[str, Any]
    diagnosis: dict[str, Any] | None
    quiet: dict[str, Any] | None = None
