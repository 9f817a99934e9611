"""Faults of instruments told without any effect: wrong units, a log over ground."""

from collections.abc import Sequence

from trawl_ros.estimation.fit.parameters import ParameterVector
from trawl_ros.estimation.screening import Screening
from trawl_ros.estimation.windows.over_ground import OverGround
from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.solver.predict import Predictor

UNIT = 'wrong unit'
JUDGED = 5
"""So many steady states are asked for their units: all of a tow have the same."""


def wrong_unit(
    predictor: Predictor, prior: ParameterVector, windows: Sequence[SteadyWindow]
) -> str | None:
    """Sentence on a channel that reports in another unit; None where none is found."""
    screening = Screening(predictor, prior, OBSERVABLES)
    for window in windows[:: max(1, len(windows) // JUDGED)]:
        rejected = screening.judge(window, prior.start).found
        if rejected is not None and rejected.reason == UNIT:
            return rejected.detail
    return None


def over_ground(windows: Sequence[SteadyWindow], tows: Sequence[str]) -> tuple[str, ...]:
    """Sentences on tows whose log gives speed over ground."""
    judge, sentences = OverGround(), {}
    for window in sorted(windows, key=lambda window: (window.tow, window.start_ns)):
        sentence = judge.judge(window.tow, window.track)
        if sentence is not None:
            sentences[window.tow] = f'{tows[window.tow]}: {sentence}.'
    return tuple(sentences.values())
