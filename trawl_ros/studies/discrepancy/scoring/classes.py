"""Effects that the planned trial cannot tell apart, found before any trial is made."""

from collections.abc import Mapping

import numpy as np

from trawl_ros.diagnosis.candidates import blocks_of_candidates
from trawl_ros.diagnosis.rules import ALIKE
from trawl_ros.studies.discrepancy.trials.strength import Likelihood


def classes(likely: Likelihood) -> Mapping[str, tuple[str, ...]]:
    """Each effect of the catalogue with all that can do what any of its parameters does alone.

    To first order, by cosines above `ALIKE` for the plan of the trial.
    """
    found = likely.mimicry
    blocks = list(zip(likely.wanted, blocks_of_candidates(likely.wanted), strict=True))
    alike: dict[str, set[str]] = {one.name: {one.name} for one, _ in blocks}
    for one, block in blocks:
        for row in np.eye(len(block)):
            alike[one.name] |= {
                other.name
                for other, rows in blocks
                if other.name != one.name and found.covered(block, row, rows) > ALIKE
            }
    return {name: tuple(sorted(names)) for name, names in alike.items()}
