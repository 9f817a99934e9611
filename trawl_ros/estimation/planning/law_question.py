# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Question about the laws of the boards, as a fit puts it on the way."""

from dataclasses import dataclass

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.fit.fit import Fit
from trawl_ros.estimation.fit.laws import (
    LawQuantities,
    WorkingAngles,
    law_quantities,
    law_spans,
    working_angles,
)
from trawl_ros.model.board_laws import BoardLaw


@dataclass(frozen=True)
class LawQuestion:
    """Question about the laws, at the angles at which the fit's windows found the boards.

    They are measured by what they were expected to span before any tow: by the span of the
    estimate, a law that turns out to have no slope could never be known well.
    """

    law: BoardLaw
    coefficients: FloatArray
    angles: WorkingAngles
    span: FloatArray

    @classmethod
    def of(cls, fit: Fit, law: BoardLaw) -> 'LawQuestion':
        """Question of a fit with one window at least, of boards that follow a law."""
        angles = working_angles([linear.state.observables for linear in fit.windows])
        span = law_spans(law, fit.prior.start, angles, fit.prior.std)
        return cls(law, fit.coefficients, angles, span)

    def quantities(self, covariance: FloatArray) -> LawQuantities:
        """Quantities of the laws with a covariance (q, q) of the coefficients."""
        return law_quantities(self.law, self.coefficients, covariance, self.angles, self.span)
