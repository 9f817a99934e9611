"""What a fit finds the instruments of each tow to be wrong by."""

import numpy as np

from trawl_ros.identification.channels import CHANNELS
from trawl_ros.identification.error_terms import TERMS, Scheme
from trawl_ros.identification.estimate import TowBias
from trawl_ros.identification.fit import Fit
from trawl_ros.identification.marginal import calibration_root, joint_root


def tow_biases(fit: Fit) -> tuple[TowBias, ...]:
    """Give the errors of calibration by tow and channel, inputs included."""
    share = Scheme(fit.options.state_share).tow_share
    joint = joint_root(fit.marginal, fit.knowledge.root)
    found = []
    for part in fit.marginal.tows:
        root = calibration_root(part, joint)
        windows = [fit.windows[row].window for row in part.errors.rows]
        for name in dict.fromkeys(term.channel for term in TERMS):
            means = [window.means[name] for window in windows if name in window.means]
            if not means:
                continue
            size = np.array(
                [
                    share * term.std * (float(np.mean(means)) if term.relative else 1.0)
                    if term.channel == name
                    else 0.0
                    for term in TERMS
                ]
            )
            found.append(
                TowBias(
                    tow=windows[0].tow,
                    channel=name,
                    unit=CHANNELS[name].unit,
                    value=float(size @ part.calibration),
                    std=float(np.linalg.norm(size @ root)),
                    known=float(np.linalg.norm(size)),
                )
            )
    return tuple(found)
