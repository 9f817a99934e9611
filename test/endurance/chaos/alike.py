"""Estimate of the undisturbed tow from the stretches that the disturbed one was measured in."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from trawl_ros.estimation.checkpoint.file import load_checkpoint
from trawl_ros.estimation.from_gear import identification_for
from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.gear.records import GearRecord
from trawl_ros.records.coefficients import COEFFICIENTS


def saved_windows(state: Path, gear: GearRecord) -> tuple[SteadyWindow, ...]:
    """Return the windows of the estimate that `identification_node` has saved; none without."""
    if not state.exists():
        return ()
    return tuple(load_checkpoint(state, identification_for(gear), gear).estimator.windows)


def same_stretches(
    calm: Sequence[SteadyWindow], wild: Sequence[SteadyWindow]
) -> list[SteadyWindow]:
    """Return the windows of one tow that overlap in time with some of another's."""
    return [
        window
        for window in calm
        if any(window.start_ns < other.end_ns and other.start_ns < window.end_ns for other in wild)
    ]


def estimate_alike(
    calm: Sequence[SteadyWindow], wild: Sequence[SteadyWindow], gear: GearRecord
) -> Mapping[str, float]:
    """Estimate coefficients from the same stretches of the undisturbed tow.

    Parameters
    ----------
    calm, wild
        Windows of the undisturbed tow, and of the disturbed one.
    gear
        Of the model that is fitted.

    Returns
    -------
    dict
        Each coefficient by its name, and the ends of its interval as ``<name> low`` and ``high``;
        empty where the tows have no stretch in common.
    """
    identification = identification_for(gear)
    identification.take(same_stretches(calm, wild))
    identification.estimator.finish()
    found = identification.estimate
    if found is None:
        return {}
    ends = (('', found.values), (' low', found.low), (' high', found.high))
    return {
        f'{name}{end}': float(value)
        for end, values in ends
        for name, value in zip(COEFFICIENTS, values, strict=True)
    }
