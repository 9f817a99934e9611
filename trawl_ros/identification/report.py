"""All that is said about one identification, worked out once for JSON, figures and tables."""

from dataclasses import dataclass

import numpy as np

from trawl_ros.errors import TrawlError
from trawl_ros.identification.estimate import Estimate
from trawl_ros.identification.estimator import Progress
from trawl_ros.identification.holdout import hold_out
from trawl_ros.identification.objective import mnae, objective, paper_values, stack
from trawl_ros.identification.pipeline import Identification
from trawl_ros.identification.prior import BoardPrior


@dataclass(frozen=True)
class Report:
    """One identification beside its data.

    Attributes
    ----------
    estimate, prior
        Where it ended and where it started.
    truth : (12,) array or None
        The coefficients that made the data, where they are known.
    rejected
        Reason → count.
    inputs : (n, 3) array
        Port and starboard warp length (m) and speed (m/s) of each window.
    states : (n,) array
        The steady state each window belongs to.
    measured, at_start, at_end, held_out : (n, 4) arrays
        The channels of eq. 35: measured, solved at the start and at the estimate, and
        predicted by fits without the window's state. NaN where there is no prediction.
    at_truth : (n, 4) array or None
        Solved at the truth.
    history
        The steps of the iteration.
    """

    estimate: Estimate
    prior: BoardPrior
    truth: np.ndarray | None
    rejected: dict[str, int]
    inputs: np.ndarray
    states: np.ndarray
    measured: np.ndarray
    at_start: np.ndarray
    at_end: np.ndarray
    held_out: np.ndarray
    at_truth: np.ndarray | None
    history: tuple[Progress, ...]

    @property
    def objectives(self) -> dict[str, float]:
        """Eq. 35 at ``start`` and ``end``, and at the ``truth`` where that is known."""
        found = {
            'start': objective(self.at_start, self.measured),
            'end': objective(self.at_end, self.measured),
        }
        if self.at_truth is not None:
            found['truth'] = objective(self.at_truth, self.measured)
        return found

    @property
    def errors(self) -> dict[str, np.ndarray]:
        """Mean normalised absolute errors (4,) at ``start``, ``end`` and ``held_out``."""
        return {
            'start': mnae(self.at_start, self.measured),
            'end': mnae(self.at_end, self.measured),
            'held_out': mnae(self.held_out, self.measured),
        }


def report(
    identification: Identification, truth: np.ndarray | None = None, folds: int = 5
) -> Report:
    """Work out the report of a finished identification.

    Parameters
    ----------
    identification
        After its `finish`.
    truth
        True coefficients (12,), where known.
    folds
        Of the hold-out.

    Raises
    ------
    TrawlError
        When there is no estimate, with the reason.
    """
    estimator, estimate = identification.estimator, identification.estimate
    if estimate is None:
        raise TrawlError(identification.why_not() or 'nothing is estimated')
    windows = estimator.windows
    return Report(
        estimate=estimate,
        prior=estimator.prior,
        truth=None if truth is None else np.asarray(truth, dtype=float),
        rejected=identification.rejected,
        inputs=np.array(
            [
                [window.means[name] for name in ('port_length', 'starboard_length', 'speed')]
                for window in windows
            ]
        ),
        states=np.array([window.state for window in windows]),
        measured=stack([paper_values(window.means) for window in windows]),
        at_start=estimator.predictions(estimator.prior.start),
        at_end=estimator.predictions(estimate.values),
        held_out=hold_out(estimator, folds),
        at_truth=None if truth is None else estimator.predictions(np.asarray(truth)),
        history=tuple(estimator.history),
    )
