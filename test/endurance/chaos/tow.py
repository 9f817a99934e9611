"""Tow with faults of the nodes."""

import time
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory

from endurance.chaos.crew import Crew, Recording, looked_into
from endurance.chaos.plan import (
    IDENTIFICATION,
    RECORDER,
    InjectedFault,
    Plan,
    write_tow,
)
from endurance.long_tow import TRUTH_HZ, write_coarse_gear
from endurance.stranger import Stranger
from endurance.watching import Glance, JournalMonitor, glance, watched_of
from trawl_ros.core.progress import OnProgress, WorkProgress
from trawl_ros.estimation.checkpoint.file import load_checkpoint
from trawl_ros.estimation.from_gear import identification_for
from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.gear.load import load_gear
from trawl_ros.gear.records import GearRecord
from trawl_ros.lab.running.own_graph import own_graph
from trawl_ros.lab.running.processes import NodeFailed, Processes

LOOK_S = 0.1
GLANCE_S = 10.0
"""Data time from one look at the processes to the next."""

STANDSTILL_S = 180.0
"""Wall time without truth after which the tow is given up; a source waits for less."""

FINISH_S = 120.0
"""Wall time that the estimate has to come to rest."""

DISK_S = 15.0
"""Wall time in which a recorder must notice that its disk is full."""


@dataclass
class DisturbedTow:
    """Result of a tow.

    ``done`` are the faults that happened; ``died`` has the last words of nodes that ended by
    themselves though nothing but messages had befallen them, and ``mute`` recorders that did not
    say that their disk was full; ``silence_s`` is the longest wall time without truth,
    ``estimate`` has the values of the last status, and ``windows`` those it is made of.
    """

    glances: list[Glance] = field(default_factory=list)
    done: list[InjectedFault] = field(default_factory=list)
    died: list[tuple[float, str]] = field(default_factory=list)
    mute: list[str] = field(default_factory=list)
    recordings: list[Recording] = field(default_factory=list)
    silence_s: float = 0.0
    towed_s: float = 0.0
    estimate: Mapping[str, str] = field(default_factory=dict)
    finish: str = ''
    windows: tuple[SteadyWindow, ...] = ()


def run_tow(
    plan: Plan,
    faults: list[InjectedFault],
    title: str,
    folder: Path,
    on_progress: OnProgress,
    stop: Callable[[], bool],
) -> DisturbedTow:
    """Tow for the hours of a plan, with its faults.

    Parameters
    ----------
    plan
        With the hours of a tow.
    faults
        Faults in order; none for the tow that others are held against.
    title
        Of the tow, for progress and what the nodes say.
    folder
        Takes what the nodes say; bags lie there for a while.
    on_progress, stop
        Called with the data time (s) that is reached; asked whether to end early.

    Raises
    ------
    NodeFailed
        If nodes cannot be started, or the estimate does not come to rest.
    """
    logs = folder / 'log' / title.replace(' ', '_')
    with (
        TemporaryDirectory(dir=folder) as name,
        own_graph(logs) as environment,
        Processes(logs, environment) as processes,
        JournalMonitor(environment) as monitor,
    ):
        scratch = Path(name)
        gear = write_coarse_gear(scratch, plan.gear)
        scenario = write_tow(scratch, gear, plan.hours, TRUTH_HZ)
        crew = Crew(processes, scenario, gear, scratch, identify=True)
        turmoil = _Turmoil(crew, processes, environment, list(faults))
        tow = turmoil.tow
        began = time.monotonic()
        moved, before = began, 0.0
        while not stop() and before < plan.end_s - 2.0 / TRUTH_HZ:
            time.sleep(LOOK_S)
            now = time.monotonic()
            turmoil.look(before, now)
            if (data_s := monitor.truth_s) is not None and data_s > before:
                moved, before = now, data_s
                on_progress(WorkProgress(title, data_s, plan.end_s, 's', turmoil.state))
                if not tow.glances or data_s >= tow.glances[-1].data_s + GLANCE_S:
                    seen = glance(watched_of(processes), data_s, now - began, {})
                    tow.glances += [seen] if seen is not None else []
            elif now - moved > STANDSTILL_S:
                break
        turmoil.close()
        tow.towed_s, tow.silence_s = before, monitor.longest_silence_s()
        if not stop():
            tow.finish = _finish(monitor, crew, turmoil)
            tow.estimate = dict(monitor.coefficients)
        processes.stop(*(node for node in processes.pids() if node != RECORDER))
        processes.stop(*(node for node in processes.pids()))
        tow.windows = saved_windows(crew.state, load_gear(gear))
        tow.recordings = [looked_into(recording, monitor) for recording in crew.recordings]
    return tow


def saved_windows(state: Path, gear: GearRecord) -> tuple[SteadyWindow, ...]:
    """Return the windows of the estimate that `identification_node` has saved; none without."""
    if not state.exists():
        return ()
    return tuple(load_checkpoint(state, identification_for(gear), gear).estimator.windows)


def _finish(monitor: JournalMonitor, crew: Crew, turmoil: '_Turmoil') -> str:
    """Finish the estimate; return the node's answer."""
    end = time.monotonic() + FINISH_S

    def waiting() -> None:
        turmoil.look(-1.0, time.monotonic())
        if time.monotonic() > end:
            raise NodeFailed(f'{IDENTIFICATION}: not finished within {FINISH_S:g} s')

    _, message = monitor.finish_identification(waiting)
    time.sleep(1.0)
    return message


class _Turmoil:
    """Faults that are active at present."""

    def __init__(
        self,
        crew: Crew,
        processes: Processes,
        environment: Mapping[str, str],
        faults: list[InjectedFault],
    ) -> None:
        self._crew = crew
        self._processes = processes
        self._environment = environment
        self._faults = faults
        self._over: tuple[float, ExitStack] | None = None
        self._full: float | None = None
        self.tow = DisturbedTow()
        self.state = ''

    def look(self, data_s: float, now: float) -> None:
        """Begin and end the faults that are due, and restart nodes that have ended."""
        self._replace_ended(data_s, now)
        if self._full is not None:
            if now - self._full > DISK_S:
                self.tow.mute.append(f'{RECORDER} goes on with a full disk')
                self._full = None
                self._crew.kill(RECORDER)
        elif self._over is not None:
            if now >= self._over[0]:
                self._over[1].close()
                self._over = None
        elif self._faults and data_s >= self._faults[0].at_s:
            self._begin(self._faults.pop(0), now)

    def close(self) -> None:
        """End the active fault."""
        if self._over is not None:
            self._over[1].close()
            self._over = None

    def _begin(self, fault: InjectedFault, now: float) -> None:
        self.state = str(fault)
        self.tow.done.append(fault)
        stack = ExitStack()
        if fault.kind == 'killed':
            self._crew.kill(fault.target)
        elif fault.kind == 'disk full':
            self._full = now
            self._crew.fill_disk()
            self._crew.ended(RECORDER, 'disk full', now)
        elif fault.kind == 'stopped':
            self._crew.stop(fault.target)
            stack.callback(self._crew.go_on, fault.target)
        else:
            stack.enter_context(Stranger(self._environment, fault.kind, fault.target))
        self._over = now + fault.for_s, stack

    def _replace_ended(self, data_s: float, now: float) -> None:
        for node, words in self._processes.ended().items():
            if node == RECORDER and self._full is not None:
                self._full = None
                if 'Traceback' in words or 'ended with code 1;' not in words:
                    self.tow.mute.append(words)
            else:
                self.tow.died.append((data_s, words))
                self._crew.ended(node, 'by itself', now)
            self._crew.start(node)
