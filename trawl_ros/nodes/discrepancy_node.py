"""`discrepancy_node`: says while a tow goes on where model and measurement disagree, and why."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, ClassVar

from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from std_srvs.srv import Trigger

from trawl_ros.core.files import empty_folder
from trawl_ros.diagnosis.diagnosis import Diagnosis, unread
from trawl_ros.diagnosis.procedure import diagnose_windows
from trawl_ros.diagnosis.report.sentences import headline
from trawl_ros.estimation.from_gear import finder_for
from trawl_ros.estimation.windows.records import RejectedWindow, SteadyWindow
from trawl_ros.gear.load import load_gear
from trawl_ros.messages.diagnostics import ERROR, OK, WARN, Status, diagnostic_array
from trawl_ros.messages.from_messages import to_sample
from trawl_ros.nodes.runtime.credit import ConsumerProgress
from trawl_ros.nodes.runtime.node import TrawlNode
from trawl_ros.nodes.runtime.parameters import Number, Text
from trawl_ros.nodes.runtime.qos import CONSUMER
from trawl_ros.nodes.runtime.reading import OneSourceEach
from trawl_ros.nodes.runtime.rewinding import Reached, Rewinding
from trawl_ros.nodes.runtime.run import run
from trawl_ros.nodes.workers.diagnosis_worker import DiagnosisOutcome, WatchingThread
from trawl_ros.nodes.workers.finding_status import CALM, finding_statuses
from trawl_ros.nodes.workers.window_parameters import WINDOW_SPECS, window_options
from trawl_ros.records.channels import CHANNELS

FINDINGS = 'discrepancy/findings'
FINISH = 'discrepancy/finish'

SAMPLES = tuple(dict.fromkeys(channel.topic for channel in CHANNELS.values()))
"""Topics that feed a channel."""


class DiscrepancyNode(TrawlNode):
    """Diagnoses all steady windows so far after each new one.

    What is found goes out on ``discrepancy/findings`` and as a warning on ``/diagnostics``.
    ``discrepancy/finish``, or the signal to end, writes the report of all tows it has heard.
    """

    SPECS: ClassVar = (
        Text('gear', 'kaifuha', 'Gear file, or the name of one that comes with the package: the '
             'gear as it is believed.'),
        Text('output', '', 'Folder for the report, new or empty; none if empty.'),
        Number('baseline_tows', 0, 'tows', 0, 100, 'So many of the first tows are of a gear in '
               'order.', whole=True),
        *WINDOW_SPECS,
    )  # fmt: skip
    DRAINS: ClassVar = True
    AWAITS: ClassVar = True

    def __init__(self, **kwargs: Any) -> None:
        super().__init__('discrepancy_node', **kwargs)
        parameters = self.parameters
        output = parameters['output']
        self._folder = empty_folder(Path(output), force=False) if output else None
        self._gear = load_gear(parameters['gear'])
        self._finder = finder_for(self._gear, window_options(parameters))
        self._windows: list[SteadyWindow] = []
        self._outcome = DiagnosisOutcome()
        self._reached = Reached()
        self._instruments = OneSourceEach()
        self._rewinding = Rewinding()
        self.advertise(FINDINGS)
        self._watching = WatchingThread(self._look_at, self._publish)
        self._progress = ConsumerProgress(self, idle=lambda: self._watching.idle)
        for topic in SAMPLES:
            self.listen(topic, self._feeder(topic), CONSUMER)
        # Alone in its group: samples still come in while the service waits for a diagnosis.
        alone = MutuallyExclusiveCallbackGroup()
        self.create_service(Trigger, FINISH, self._finish, callback_group=alone)
        self._watching.start()

    def statuses(self) -> list[Status]:
        """Return the status of the diagnosis."""
        diagnosis, trouble = self._outcome.diagnosis, self._outcome.trouble
        values = {'windows': str(len(self._windows))}
        if trouble:
            return [Status('discrepancy', ERROR, trouble, values)]
        if diagnosis is None:
            return [Status('discrepancy', OK, 'waiting for a steady window', values)]
        level = OK if diagnosis.verdict in CALM else WARN
        values |= {'verdict': diagnosis.verdict}
        return [Status('discrepancy', level, headline(diagnosis), values)]

    def finish_work(self) -> None:
        """Decide the remaining windows, diagnose, and write the report."""
        self._take(self._finder.finish())
        self._watching.stop()
        self._tell(self._write())

    def _feeder(self, topic: str) -> Callable[[Any], None]:
        def feed(message: Any) -> None:
            sample = to_sample(topic, message)
            anew, samples = self._rewinding.take(sample)
            if anew:
                self._forget()
            for one in samples:
                if one is sample:
                    self._instruments.check(topic, sample)
                self._take(self._finder.feed(one))
                self._progress.done(self._reached.take(one.stamp))

        return feed

    def _forget(self) -> None:
        self._finder.reset()
        self._instruments.forget()
        self._watching.forget()
        self._windows, self._reached, self._outcome = [], Reached(), DiagnosisOutcome()
        self.get_logger().warning('stamps of the winch went back; all begins anew')

    def _take(self, decided: Sequence[SteadyWindow | RejectedWindow]) -> None:
        steady = [window for window in decided if isinstance(window, SteadyWindow)]
        if steady:
            self._windows += steady
            self._watching.look_at(tuple(self._windows))

    def _look_at(self, windows: tuple[SteadyWindow, ...]) -> Diagnosis:
        tows = [f'tow {number + 1}' for number in range(1 + max(w.tow for w in windows))]
        baseline = frozenset(range(self.parameters['baseline_tows']))
        return diagnose_windows(self._gear, windows, tows, baseline)

    def _publish(self, outcome: DiagnosisOutcome) -> None:
        self._outcome = replace(outcome, diagnosis=outcome.diagnosis or self._outcome.diagnosis)
        if outcome.diagnosis is not None:
            statuses = finding_statuses(outcome.diagnosis)
            self.send(FINDINGS, diagnostic_array(self._reached.stamp, statuses))

    def _write(self) -> tuple[str, bool]:
        """Write the report; return the closing sentence, and True if all windows count."""
        diagnosis, trouble = self._outcome.diagnosis, self._outcome.trouble
        if diagnosis is None:
            diagnosis = unread(self._gear, (), trouble or 'no steady window has been heard')
        sentence = f'{diagnosis.verdict}: {headline(diagnosis)}'
        if self._folder is not None:
            # Figures bring matplotlib, which the node needs at its end only.
            from trawl_ros.diagnosis.report.writing import write_diagnosis

            write_diagnosis(diagnosis, (), self._folder)
            sentence = f'{self._folder}: {sentence}'
        if trouble:
            sentence = (
                f'the newest windows could not be diagnosed ({trouble}); before them: {sentence}'
            )
        return sentence, not trouble

    def _tell(self, written: tuple[str, bool]) -> None:
        sentence, complete = written
        log = self.get_logger()
        (log.info if complete else log.warning)(sentence)

    async def _finish(self, request: Any, response: Any) -> Any:
        self._take(self._finder.finish())
        await self._watching
        written = self._write()
        response.message, response.success = written
        self._tell(written)
        return response


def main(args: Sequence[str] | None = None) -> int:
    """Run the node."""
    return run(DiscrepancyNode, args)
