"""Recorder killed again and again at full load."""

import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from endurance.chaos.crew import Crew, Recording, looked_into
from endurance.chaos.plan import RECORDER, Plan, write_tow
from endurance.chaos.tow import LOOK_S
from endurance.long_tow import write_coarse_gear
from endurance.watching import JournalMonitor
from trawl_ros.core.progress import OnProgress, step_counter
from trawl_ros.lab.running.own_graph import own_graph
from trawl_ros.lab.running.processes import NodeFailed, Processes
from trawl_ros.scenario.records import MAX_TRUTH_HZ

HOURS = 24.0
"""More than is towed."""

RECORDS_S = (1.0, 3.0)
"""Wall time that a recorder records before it is killed; least and most."""

START_S = 60.0
"""Wall time in which a recorder must have begun."""


@dataclass(frozen=True)
class Kills:
    """Bags of the recorders that were killed, and how long they recorded (wall time, s)."""

    recordings: tuple[Recording, ...]
    recorded_s: float


def run_kills(plan: Plan, folder: Path, on_progress: OnProgress, stop: Callable[[], bool]) -> Kills:
    """Kill the recorder as often as planned, each time at another moment.

    Parameters
    ----------
    plan
        With the number of kills.
    folder
        Takes what the nodes say; bags lie there for a while.
    on_progress, stop
        Called after each of them; asked whether to end early.

    Raises
    ------
    NodeFailed
        If a node ends by itself, or does not begin.
    """
    rng = np.random.default_rng(plan.seed)
    logs = folder / 'log' / 'kills'
    recorded_s = 0.0
    with (
        TemporaryDirectory(dir=folder) as name,
        own_graph(logs) as environment,
        Processes(logs, environment) as processes,
        JournalMonitor(environment) as monitor,
    ):
        scratch = Path(name)
        gear = write_coarse_gear(scratch, plan.gear)
        scenario = write_tow(scratch, gear, HOURS, MAX_TRUTH_HZ)
        crew = Crew(processes, scenario, gear, scratch, identify=False)
        done = step_counter('recorder killed', plan.kills, on_progress)
        for _ in range(plan.kills):
            reached, patience = monitor.truth_s or 0.0, time.monotonic() + START_S
            while monitor.done_s(RECORDER) <= reached and not stop():
                processes.check()
                time.sleep(LOOK_S)
                if time.monotonic() > patience:
                    raise NodeFailed(f'{RECORDER}: records nothing within {START_S:g} s')
            if stop():
                break
            began = time.monotonic()
            time.sleep(rng.uniform(*RECORDS_S))
            recorded_s += time.monotonic() - began
            crew.kill(RECORDER)
            done()
        recordings = [looked_into(each, monitor) for each in crew.recordings if each.ended]
    return Kills(tuple(recordings), recorded_s)
