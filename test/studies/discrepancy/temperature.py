"""Temperature of the log Bayes factors, fitted on trials of development seeds."""

from collections.abc import Sequence

import numpy as np
from scipy.special import logsumexp

from studies.discrepancy.trial import BlindTrial
from trawl_ros.lab.missing_effect.calibration import CalibrationOptions

TEMPERATURES = (0.7, 0.85, 1.0, 1.2, 1.4, 1.5, 1.7, 2.0, 2.5, 3.0, 4.0)


def of_truth(trial: BlindTrial, temperature: float) -> float:
    """Return the probability of what is hidden: its node, nothing, or something else."""
    truth, _ = trial.case
    weights = np.array([odds + factor / temperature for *_, odds, factor in trial.explanations])
    held = 0.0
    for log_share, (nodes, unknown, _, _) in zip(
        weights - logsumexp(weights), trial.explanations, strict=True
    ):
        if truth.series == 'clean':
            right = not nodes and not unknown
        elif truth.series == 'outside':
            right = bool(unknown)
        else:
            right = all(set(cause.nodes) & set(nodes) for cause in truth.causes)
        held += float(np.exp(log_share)) * right
    return held


def best_temperature(trials: Sequence[BlindTrial]) -> float:
    """Return the temperature with the largest mean log probability of what is hidden."""
    least = CalibrationOptions().least_probability

    def score(temperature: float) -> float:
        return float(np.mean([np.log(max(of_truth(own, temperature), least)) for own in trials]))

    return max(TEMPERATURES, key=score)
