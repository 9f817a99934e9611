# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Parameters of the derivatives of a tow in motion."""

from dataclasses import dataclass
from functools import cached_property

from trawl_ros.core.arrays import Slice
from trawl_ros.effects.base.effect import Effect

NET = ('drag', 'weight')
"""Factors on drag and weight in water of the net."""


@dataclass(frozen=True)
class MotionParameters:
    """Parameters of the derivatives of a tow, grouped by kind.

    Names are those of the groups of a fit's parameter vector.

    Attributes
    ----------
    coefficients
        Names of the parameters of the boards' law; none if the coefficients are held.
    net
        True to include the two factors on drag and weight in water of the net.
    effects
        Effects whose values are parameters.
    inputs
        Names of errors of counters and log; their course in time comes with the inputs
        (`trawl_ros.solver.motion.course.InputPoint`).
    motions
        Number of slow motions in which the gear may begin (`slow_motions` of
        `trawl_ros.solver.motion.tow`).
    """

    coefficients: tuple[str, ...] = ()
    net: bool = False
    effects: tuple[Effect, ...] = ()
    inputs: tuple[str, ...] = ()
    motions: int = 0

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names (m) of all parameters, in order."""
        return (
            *self.coefficients,
            *(NET if self.net else ()),
            *(f'{effect.name} {own.name}' for effect in self.effects for own in effect.parameters),
            *self.inputs,
            *(f'motion {number + 1}' for number in range(self.motions)),
        )

    def __len__(self) -> int:
        return len(self.names)

    @cached_property
    def _starts(self) -> tuple[int, ...]:
        sizes = (
            len(self.coefficients),
            len(NET) if self.net else 0,
            sum(len(effect.parameters) for effect in self.effects),
            len(self.inputs),
            self.motions,
        )
        return tuple(sum(sizes[:number]) for number in range(len(sizes) + 1))

    @property
    def of_coefficients(self) -> Slice:
        """Slice of the coefficients of the boards."""
        return slice(self._starts[0], self._starts[1])

    @property
    def of_net(self) -> Slice:
        """Slice of the net's factors."""
        return slice(self._starts[1], self._starts[2])

    @property
    def of_effects(self) -> Slice:
        """Slice of the values of the effects."""
        return slice(self._starts[2], self._starts[3])

    @property
    def of_inputs(self) -> Slice:
        """Slice of the additions to the inputs."""
        return slice(self._starts[3], self._starts[4])

    @property
    def of_motions(self) -> Slice:
        """Slice of the first slow motions."""
        return slice(self._starts[4], self._starts[5])
