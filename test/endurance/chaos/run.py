"""Study of fault injection: a tow undisturbed, the same with faults, and the recorder killed."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from endurance.chaos.kills import Kills, run_kills
from endurance.chaos.plan import Plan, faults_of
from endurance.chaos.tow import DisturbedTow, run_tow
from endurance.long_tow import COARSEST
from trawl_ros.core.files import made_folder
from trawl_ros.core.progress import OnProgress
from trawl_ros.estimation.from_gear import identification_for
from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.gear.records import GearRecord
from trawl_ros.lab.trials.linearised_plant import MeshResolution
from trawl_ros.records.coefficients import COEFFICIENTS


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


@dataclass(frozen=True)
class Chaos:
    """Results of the tow without faults and with them, and of the killed recorders.

    ``alike`` has the coefficients by name from those stretches of the tow without faults that the
    other has windows of.
    """

    plan: Plan
    calm: DisturbedTow
    wild: DisturbedTow
    kills: Kills
    alike: Mapping[str, float] = field(default_factory=dict)


def run_chaos(plan: Plan, folder: Path, on_progress: OnProgress, stop: Callable[[], bool]) -> Chaos:
    """Run all three, each node as a process of its own.

    Parameters
    ----------
    plan
        With the hours of a tow and the number of kills.
    folder
        Takes what the nodes say; bags lie there for a while.
    on_progress
        Called with the data time (s) or the number of kills that is reached.
    stop
        Asked now and then whether to end early; what was seen until then counts.

    Raises
    ------
    NodeFailed
        If nodes cannot be started.
    """
    made_folder(folder)
    calm = run_tow(plan, [], 'undisturbed', folder, on_progress, stop)
    wild = (
        DisturbedTow()
        if stop()
        else run_tow(plan, faults_of(plan), 'chaos', folder, on_progress, stop)
    )
    kills = Kills((), 0.0) if stop() else run_kills(plan, folder, on_progress, stop)
    alike = estimate_alike(calm.windows, wild.windows, MeshResolution(COARSEST).model(plan.gear))
    return Chaos(plan, calm, wild, kills, alike)
