# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Information of whitened stretches on the parameters, group by group of channels."""

from collections.abc import Sequence
from dataclasses import dataclass

from scipy.linalg import cholesky

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.least_squares.information import Information
from trawl_ros.estimation.motion.processes import ErrorSizes, ErrorTimes, GroupRows


@dataclass(frozen=True)
class LinearGroup:
    """Rows of one group, with their derivatives (m, p) and residuals (m,) at nought."""

    rows: GroupRows
    columns: FloatArray
    residual: FloatArray

    def root(self, sizes: FloatArray, times: ErrorTimes) -> FloatArray:
        """Lower Cholesky factor (m, m) of the covariance of the errors."""
        found: FloatArray = cholesky(self.rows.covariance(sizes, times), lower=True)
        return found

    def information(self, sizes: FloatArray, times: ErrorTimes) -> Information:
        """Information on the parameters, by sizes (5,) of the errors."""
        if not len(self.residual):
            return Information.none(self.columns.shape[1])
        return Information.whitened(self.root(sizes, times), self.columns, self.residual)


def group_information(
    groups: Sequence[LinearGroup], sizes: ErrorSizes, times: ErrorTimes
) -> list[Information]:
    """Information of each group of channels of a tow."""
    return [group.information(sizes.of_group(number), times) for number, group in enumerate(groups)]
