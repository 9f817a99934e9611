# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""`discrepancy_node`: says while a tow goes on where model and measurement disagree, and why."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from threading import Lock
from typing import TYPE_CHECKING, Any, ClassVar

from trawl_ros.core.errors import TrawlError
from trawl_ros.diagnosis.diagnosis import Diagnosis, unread
from trawl_ros.diagnosis.onset.findings import Finding
from trawl_ros.diagnosis.onset.knowledge import of_identification
from trawl_ros.diagnosis.onset.log_book import Event, LogBook
from trawl_ros.diagnosis.procedure import diagnose_windows
from trawl_ros.diagnosis.report.sentences import headline
from trawl_ros.estimation.from_gear import finder_for
from trawl_ros.estimation.windows.records import RejectedWindow, SteadyWindow
from trawl_ros.gear.load import load_gear
from trawl_ros.messages.diagnostics import ERROR, OK, WARN, Status, diagnostic_array
from trawl_ros.messages.from_messages import to_sample
from trawl_ros.nodes.runtime.credit import ConsumerProgress
from trawl_ros.nodes.runtime.node import TrawlNode
from trawl_ros.nodes.runtime.parameters import Flag, Number, Text
from trawl_ros.nodes.runtime.qos import CONSUMER
from trawl_ros.nodes.runtime.reading import OneSourceEach, Reached, Rewinding
from trawl_ros.nodes.runtime.run import run
from trawl_ros.nodes.workers.diagnosis_worker import DiagnosisOutcome, DiagnosisWorker
from trawl_ros.nodes.workers.finding_status import (
    CALM,
    finding_statuses,
    onset_status,
    onset_watch_status,
)
from trawl_ros.nodes.workers.onset_worker import OnsetWorker
from trawl_ros.nodes.workers.settings import WINDOW_SPECS, window_options

if TYPE_CHECKING:
    from trawl_ros.diagnosis.onset.monitor import OnsetMonitor
from trawl_ros.records.channels import READ_TOPICS
from trawl_ros.records.samples import Sample

FINDINGS = 'discrepancy/findings'
FINISH = 'discrepancy/finish'
ACKNOWLEDGE = 'discrepancy/acknowledge'
DISMISS = 'discrepancy/dismiss'

OPERATOR = 'operator'
"""Name in the log book of the one who decides: a service does not know by whom it is called."""

MOST_TOLD = 5
"""Newest findings of what has begun that are published with each."""


class DiscrepancyNode(TrawlNode):
    """Diagnoses all steady windows so far after each new one, and watches for what begins.

    What is found goes out on ``discrepancy/findings`` and as a warning on ``/diagnostics``.
    ``discrepancy/finish``, or the signal to end, writes the report of all tows it has heard. The
    operator's ``discrepancy/acknowledge`` and ``discrepancy/dismiss`` are about the newest finding
    of what has begun.
    """

    SPECS: ClassVar = (
        Text('gear', 'kaifuha', 'Gear file, or the name of one that comes with the package: the '
             'gear as it is believed.'),
        Text('output', '', 'Folder for the report; where it holds files, a number is put behind '
             'its name; none if empty.'),
        Number('baseline_tows', 0, 'tows', 0, 100, 'So many of the first tows are of a gear in '
               'order.', whole=True),
        Flag('watch', False, 'True if the tow is watched without pause for what begins in it.'),
        Text('estimate', '', 'An identification.json: boards and errors as they are known when a '
             'tow is watched; by the prior of the gear file, and as stated, if empty.'),
        Text('log_book', '', 'File for the log book of findings, which is gone on with; none if '
             'empty.'),
        *WINDOW_SPECS,
    )  # fmt: skip
    DRAINS: ClassVar = True

    def __init__(self, **kwargs: Any) -> None:
        super().__init__('discrepancy_node', **kwargs)
        parameters = self.parameters
        self._folder = self.new_path('output', or_empty=True)
        self._gear = load_gear(parameters['gear'])
        self._finder = finder_for(self._gear, window_options(parameters))
        self._windows: list[SteadyWindow] = []
        self._outcome = DiagnosisOutcome()
        self._reached, self._dealt = Reached(), Reached()
        self._told: dict[int, Finding] = {}
        self._acknowledged: set[int] = set()
        self._instruments = OneSourceEach()
        self._rewinding = Rewinding()
        self._verdict: list[Status] = []
        self._telling = Lock()
        self._open_book()
        self.advertise(FINDINGS)
        self._watching = DiagnosisWorker(self._look_at, self._publish)
        self._progress = ConsumerProgress(self, idle=self._idle, busy=lambda: not self._idle())
        watched = parameters['watch'] and self._gear.pair is None
        self._monitor = self._new_monitor() if watched else None
        self._onset = (
            None
            if self._monitor is None
            else OnsetWorker(self._monitor, self._tell_finding, self._watched)
        )
        for topic in READ_TOPICS:
            self.listen(topic, self._feeder(topic), CONSUMER)
        self.offer_awaiting(FINISH, self._finish)
        self.offer(ACKNOWLEDGE, self._acknowledge)
        self.offer(DISMISS, self._dismiss)
        self._watching.start()
        if self._onset is not None:
            self._onset.start()

    def _open_book(self) -> None:
        path = self.parameters['log_book']
        self._book = LogBook(Path(path)) if path else None
        self._book_trouble = ''
        self._log('begun')

    def _new_monitor(self) -> 'OnsetMonitor':
        # Its libraries are loaded where a tow is watched alone.
        from trawl_ros.diagnosis.onset.monitor import OnsetMonitor

        estimate = self.parameters['estimate']
        names = self._gear.board.parameters.names
        knowledge = of_identification(Path(estimate), names) if estimate else None
        last = self._book.last_number() if self._book is not None else 0
        return OnsetMonitor(self._gear, knowledge, last_number=last)

    def _idle(self) -> bool:
        return self._watching.idle and (self._onset is None or self._onset.idle)

    def statuses(self) -> list[Status]:
        """Return the statuses of the diagnosis, and of the watch for what begins."""
        return [*self._of_diagnosis(), *self._of_watch()]

    def _of_watch(self) -> list[Status]:
        if self._monitor is None or self._onset is None:
            return []
        return [onset_watch_status(self._monitor, self._onset.trouble or self._book_trouble)]

    def _of_diagnosis(self) -> list[Status]:
        diagnosis, trouble = self._outcome.diagnosis, self._outcome.trouble
        values = {'windows': str(len(self._windows))}
        if trouble:
            return [Status('discrepancy', ERROR, trouble, values)]
        if diagnosis is None:
            waits = self.with_namespace('waiting for a steady window')
            return [Status('discrepancy', OK, waits, values)]
        level = OK if diagnosis.verdict in CALM else WARN
        values |= {'verdict': diagnosis.verdict}
        return [Status('discrepancy', level, headline(diagnosis), values)]

    def finish_work(self) -> None:
        """Decide the remaining windows, diagnose, and write the report."""
        self._take(self._finder.finish())
        self._watching.stop()
        if self._onset is not None:
            self._onset.stop()
        self._tell(self._write())

    def _feeder(self, topic: str) -> Callable[[Any], None]:
        def feed(message: Any) -> None:
            sample = to_sample(topic, message)
            rewound, samples = self._rewinding.take(sample)
            if rewound:
                self._forget()
            for one in samples:
                if one is sample:
                    self._instruments.check(topic, sample)
                self._take(self._finder.feed(one))
                self._reached.take(one.stamp)
                if self._onset is None:
                    self._progress.done(self._reached.stamp)
                else:
                    self._onset.put(one)

        return feed

    def _watched(self, sample: Sample) -> None:
        self._progress.done(self._dealt.take(sample.stamp))

    def _tell_finding(self, finding: Finding) -> None:
        """Publish a finding of what has begun, and list the subscribed nodes in the log book."""
        before = self._told.get(finding.number)
        self._told[finding.number] = finding
        if before is None or before.state != finding.state:
            self._log(finding.state, finding)
            self.get_logger().warning(
                f'finding {finding.number} {finding.state}: {finding.sentence()}'
            )
        if before is None or before.state != finding.state or before.name != finding.name:
            # Before it is sent: an operator may answer sooner than a line is written.
            topic = self.resolve_topic_name(FINDINGS)
            heard = {one.node_name for one in self.get_subscriptions_info_by_topic(topic)}
            self._log('published', finding, to=sorted(heard))
        self._send_findings()

    def _send_findings(self) -> None:
        # Two workers and the operator come here; of two messages the newer one must go out last.
        with self._telling:
            acknowledged = self._acknowledged
            newest = self._newest_findings()
            statuses = [onset_status(one, one.number in acknowledged) for one in newest]
            stamp = self._reached.stamp or self.now()
            self.send(FINDINGS, diagnostic_array(stamp, [*self._verdict, *statuses]))

    def _newest_findings(self) -> list[Finding]:
        """Newest findings of what has begun."""
        return [self._told[number] for number in sorted(self._told)[-MOST_TOLD:]]

    def _log(
        self, event: Event, finding: Finding | None = None, *, who: str = '', to: Sequence[str] = ()
    ) -> None:
        if self._book is None:
            return
        try:
            self._book.write(event, self._reached.stamp, who or self.get_name(), finding, to)
        except TrawlError as reason:
            self._book_trouble = str(reason)
        else:
            self._book_trouble = ''

    def _newest_finding(self) -> Finding:
        findings = self._newest_findings()
        if not findings:
            raise TrawlError('nothing has been found to begin')
        return findings[-1]

    def _acknowledge(self) -> str:
        finding = self._newest_finding()
        if finding.number in self._acknowledged:
            # Written again and again, it would drive what is older out of the log book.
            return f'finding {finding.number} is acknowledged already: {finding.sentence()}'
        self._acknowledged.add(finding.number)
        self._log('acknowledged', finding, who=OPERATOR)
        self._send_findings()
        return f'finding {finding.number} is acknowledged: {finding.sentence()}'

    def _dismiss(self) -> str:
        finding = self._newest_finding()
        dismissed = None if self._onset is None else self._onset.dismiss(finding.number)
        if dismissed is None:
            raise TrawlError(f'finding {finding.number} is {finding.state} already')
        self._told[finding.number] = dismissed
        self._log('dismissed', dismissed, who=OPERATOR)
        self._send_findings()
        return f'finding {finding.number} is dismissed: {dismissed.sentence()}'

    def _forget(self) -> None:
        self._finder.reset()
        self._instruments.forget()
        self._watching.forget()
        if self._onset is not None:
            self._onset.reset()
        self._windows, self._reached, self._outcome = [], Reached(), DiagnosisOutcome()
        self._dealt = Reached()
        self.get_logger().warning('stamps of the winch went back; everything begins again')

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
            self._verdict = finding_statuses(outcome.diagnosis)
            self._send_findings()

    def _write(self) -> tuple[str, bool]:
        """Write the report; return the closing sentence, and True if all windows count."""
        diagnosis, trouble = self._outcome.diagnosis, self._outcome.trouble
        if diagnosis is None:
            nothing = self.with_namespace('no steady window has been heard')
            diagnosis = unread(self._gear, (), trouble or nothing)
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
        if self._onset is not None:
            await self._onset
        written = self._write()
        response.message, response.success = written
        self._tell(written)
        return response


def main(args: Sequence[str] | None = None) -> int:
    """Run the node."""
    return run(DiscrepancyNode, args)
