"""The estimator for a gear: its model, and start values and bounds from its file."""

import numpy as np

from trawl_ros.gear.records import GearRecord
from trawl_ros.identification.estimator_options import EstimatorOptions
from trawl_ros.identification.pipeline import Identification
from trawl_ros.identification.prior import BoardPrior
from trawl_ros.identification.window_records import WindowOptions
from trawl_ros.model.gear_model import build_model
from trawl_ros.model.observables import OBSERVABLES
from trawl_ros.solver.predict import Predictor


def board_prior(gear: GearRecord) -> BoardPrior:
    """What a gear file knows of its board before any tow."""
    known = gear.identification
    return BoardPrior(
        start=np.array(known.start),
        std=np.array(known.std),
        low=np.array(known.low),
        high=np.array(known.high),
    )


def identification_for(
    gear: GearRecord,
    *,
    window_options: WindowOptions | None = None,
    estimator_options: EstimatorOptions | None = None,
) -> Identification:
    """Build the one estimator that node and command line share.

    Parameters
    ----------
    gear
        From `load_gear`: the model as it is believed, not the plant.
    window_options, estimator_options
        When a window is steady; how the estimate is found.
    """
    model = build_model(gear)
    return Identification(
        Predictor(model),
        board_prior(gear),
        OBSERVABLES,
        model.water.depth,
        window_options,
        estimator_options,
    )
