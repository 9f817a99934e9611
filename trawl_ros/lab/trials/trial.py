# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Records of a blind trial: its specification and its key."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

Form = Literal['windows', 'bags', 'dynamic']
Series = Literal['clean', 'alone', 'outside', 'pair']


@dataclass(frozen=True)
class Spec:
    """Specification of a trial.

    Attributes
    ----------
    series
        Nothing hidden, one cause of the library, one outside of it, or two causes.
    number
        Number of the trial for this seed.
    effects
        Names of the hidden causes.
    strength
        Strength of each, in smallest detectable sizes.
    signs
        Sign of the size of each.
    plant
        Number of the plant.
    plan
        Name of one of `PLANS`.
    form
        Form of the data: windows computed from linearised steady states, bags of one steady state
        after another, or bags of tows simulated in time.
    """

    series: Series
    number: int
    effects: tuple[str, ...]
    strength: float
    signs: tuple[float, ...]
    plant: int
    plan: str = 'full'
    form: Form = 'windows'


@dataclass(frozen=True)
class Key:
    """Key of a trial; only the scorer reads it.

    Attributes
    ----------
    spec
        Specification of the trial.
    sizes, units
        Size of each hidden cause, and its unit.
    detectable
        Smallest detectable size of each.
    testable, why_not
        False if the trial cannot be made, and the reason.
    coefficients
        Board coefficients (12,) of the plant.
    floor
        RMS errors by channel, on the held-out windows, of the plant itself as a model.
    """

    spec: Spec
    sizes: tuple[float, ...]
    units: tuple[str, ...]
    detectable: tuple[float, ...]
    testable: bool
    why_not: str
    coefficients: tuple[float, ...]
    floor: Mapping[str, float]
