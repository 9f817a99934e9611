"""Soak test: the chain for a day at sea at full speed, then for a minute in real time."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from shutil import disk_usage
from tempfile import TemporaryDirectory

from endurance.long_tow import TRUTH_HZ, write_coarse_gear, write_long_tow
from endurance.watching import BAG_PART_S, DelayMonitor, Glance, watch_chain
from trawl_ros.core.errors import TrawlError
from trawl_ros.core.files import made_folder
from trawl_ros.core.progress import OnProgress, WorkProgress
from trawl_ros.lab.running.chain import start_chain
from trawl_ros.lab.running.own_graph import own_graph
from trawl_ros.lab.running.processes import Processes
from trawl_ros.scenario.records import MAX_TRUTH_HZ

GLANCES = 500
"""Number of glances at a tow, however long it is."""

SETTLE_S = 10.0
"""Wall time at the start of the run in real time that is not counted."""

MOST_BAG_MB_PER_HOUR = 250.0
"""Room that the bag of a tow may need; it is gone again afterwards."""


@dataclass(frozen=True)
class SoakPlan:
    """Plan of the soak: hours at sea at full speed, and seconds in real time.

    ``truth_rate_hz`` is how often there is truth at sea; in real time it is the usual rate.
    ``coarse`` says that the gear of the long tow has a coarse net.
    """

    hours: float
    gear: str
    real_time_s: float
    truth_rate_hz: float = TRUTH_HZ
    coarse: bool = False


@dataclass(frozen=True)
class Soak:
    """Result of a soak: glances on the long tow and in real time, and size of its bag."""

    plan: SoakPlan
    fast: tuple[Glance, ...]
    real: tuple[Glance, ...]
    bag_mb: float


def run_soak(
    plan: SoakPlan, folder: Path, on_progress: OnProgress, stop: Callable[[], bool]
) -> Soak:
    """Run the chain, each node as a process of its own.

    Parameters
    ----------
    plan
        With hours and rates.
    folder
        Takes what the nodes say; bags lie there for a while.
    on_progress
        Called now and then with the data time (s) that is reached.
    stop
        Asked now and then whether to end early; what was seen until then counts.

    Raises
    ------
    TrawlError
        If there is no room for the bag.
    NodeFailed
        If a node ends by itself, or cannot end cleanly.
    """
    made_folder(folder)
    needed, free = plan.hours * MOST_BAG_MB_PER_HOUR, disk_usage(folder).free / 1e6
    if free < needed:
        raise TrawlError(
            f'{folder}: {free:.0f} MB are free there, expected {needed:.0f} MB for the bag'
        )
    with TemporaryDirectory(dir=folder) as name:
        scratch = Path(name)
        gear = write_coarse_gear(scratch, plan.gear) if plan.coarse else plan.gear
        logs = folder / 'log'
        fast = _run(gear, plan.hours, plan.truth_rate_hz, 0.0, scratch, logs, on_progress, stop)
        # Ended early, there may be no bag yet, in which nothing is found.
        bag_mb = sum(file.stat().st_size for file in (scratch / 'bag').glob('*')) / 1e6
    real: list[Glance] = []
    if plan.real_time_s and not stop():
        hours = (SETTLE_S + plan.real_time_s) / 3600.0
        with TemporaryDirectory(dir=folder) as name:
            logs = folder / 'log' / 'real_time'
            real = _run(plan.gear, hours, MAX_TRUTH_HZ, 1.0, Path(name), logs, on_progress, stop)
    return Soak(plan, tuple(fast), tuple(real), bag_mb)


def _run(
    gear: str,
    hours: float,
    truth_hz: float,
    time_scale: float,
    scratch: Path,
    logs: Path,
    on_progress: OnProgress,
    stop: Callable[[], bool],
) -> list[Glance]:
    scenario = write_long_tow(scratch, gear, hours, truth_hz)
    title = 'in real time' if time_scale else 'at sea'
    with (
        own_graph(logs) as environment,
        Processes(logs, environment) as processes,
        DelayMonitor(environment) as monitor,
    ):
        start_chain(processes, scenario, scratch / 'bag', time_scale, BAG_PART_S)
        every = 1.0 if time_scale else 3600.0 * hours / GLANCES
        stage = WorkProgress(title, 0.0, 3600.0 * hours, 's')
        return watch_chain(processes, monitor, every, stage, on_progress, stop)
