"""Best fit of readings without errors: the limit of the model's approach to the plant."""

from collections.abc import Sequence
from typing import Any

from trawl_ros.diagnosis.diagnosis import values_of
from trawl_ros.diagnosis.holdout import split
from trawl_ros.diagnosis.refit import fit_boards, refitted
from trawl_ros.diagnosis.score_test import score_test
from trawl_ros.effects.effect_set import effects_of
from trawl_ros.effects.registry import catalogue
from trawl_ros.estimation.from_gear import board_prior
from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.gear.records import GearRecord
from trawl_ros.model.gear_model import build_model
from trawl_ros.records.coefficients import COEFFICIENTS
from trawl_ros.solver.predict import Predictor


def fit_quietly(
    gear: GearRecord, windows: Sequence[SteadyWindow], name: str, baseline: frozenset[int]
) -> dict[str, Any] | None:
    """Fit boards and one effect of the catalogue to the windows that decide.

    Returns
    -------
    dict or None
        Values by the effect's ``parameters`` and by ``coefficients``; None where nothing fits.
    """
    predictor = Predictor(build_model(gear), effects_of(gear), without=baseline)
    base = fit_boards(predictor, board_prior(gear), split(windows, baseline).deciding)
    if base is None:
        return None
    seen = score_test(predictor, base.fit, {name: catalogue()[name]})
    best = refitted(predictor, base, seen, (max(seen.wanted, key=seen.penalised),))
    if best is None:
        return None
    coefficients = map(float, best.estimate.values[: len(COEFFICIENTS)])
    return {
        'parameters': {key: value for key, (value, *_) in values_of(best)[name].items()},
        'coefficients': dict(zip(COEFFICIENTS, coefficients, strict=True)),
    }
