# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""`identification_node`: refits the boards' coefficients while samples come in."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from threading import Lock
from typing import Any, ClassVar

from trawl_ros.core.files import is_there
from trawl_ros.estimation.checkpoint.file import (
    CheckpointError,
    load_checkpoint,
    save_checkpoint,
)
from trawl_ros.estimation.fit.estimate import Estimate
from trawl_ros.estimation.from_gear import (
    board_prior,
    estimator_options,
    identification_for,
    predictor_for,
)
from trawl_ros.estimation.pipeline import Identification
from trawl_ros.estimation.planning.advice import Advice
from trawl_ros.estimation.planning.next_manoeuvre import Adviser
from trawl_ros.estimation.planning.proposals import knowledge_of
from trawl_ros.gear.load import load_gear
from trawl_ros.messages.diagnostics import ERROR, OK, WARN, Status, diagnostic_array
from trawl_ros.messages.estimates import (
    COEFFICIENTS_BY_NAME,
    COVARIANCE,
    ESTIMATE,
    INNOVATION,
    INNOVATIONS_BY_NAME,
    coefficients_message,
    covariance_message,
    estimate_message,
    innovation_message,
    innovations_message,
)
from trawl_ros.messages.from_messages import to_sample
from trawl_ros.nodes.runtime.credit import ConsumerProgress
from trawl_ros.nodes.runtime.node import TrawlNode
from trawl_ros.nodes.runtime.parameters import Flag, Text
from trawl_ros.nodes.runtime.qos import CONSUMER
from trawl_ros.nodes.runtime.reading import OneSourceEach, Rewinding
from trawl_ros.nodes.runtime.run import run
from trawl_ros.nodes.workers.advice_worker import AdviceWorker
from trawl_ros.nodes.workers.estimate_status import (
    advice_status,
    identification_statuses,
    innovations_of,
    motion_diagnosis,
)
from trawl_ros.nodes.workers.identification_report import ReportWriter
from trawl_ros.nodes.workers.identification_worker import IdentificationWorker
from trawl_ros.nodes.workers.motion_learner import MotionLearner
from trawl_ros.nodes.workers.outcome import EstimatorOutcome
from trawl_ros.nodes.workers.proposals import knowledge_status
from trawl_ros.nodes.workers.settings import (
    ADVICE_SPECS,
    WINDOW_SPECS,
    advice_limits,
    window_options,
)
from trawl_ros.records.channels import CHANNELS
from trawl_ros.scenario.scenario import true_coefficients

STATUS = 'identification/status'
FINISH = 'identification/finish'

SAMPLES = tuple(dict.fromkeys(channel.topic for channel in CHANNELS.values()))
"""Topics that feed a channel."""


class IdentificationNode(TrawlNode):
    """Finds steady windows in what the instruments report and refits the gear's model to them.

    After each accepted window it publishes the estimate, its covariance, a status and the
    innovation, and saves its state; where the whole tow is learned from, an estimate by it after
    each half minute. ``identification/finish``, or the signal to end, brings the estimate to rest
    and writes the report; the former fits the whole tow too.
    """

    SPECS: ClassVar = (
        Text('gear', 'kaifuha', 'Gear file, or the name of one that comes with the package: the '
             'model that is fitted.'),
        Flag('prior', True, 'Whether what is known of the board beforehand takes part; the bounds '
             'always do.'),
        Flag('net', False, 'Whether drag and weight of the net are estimated along; else they are '
             'held as the gear file has them.'),
        Text('output', '', 'Folder for identification.json and figures; where it holds files, a '
             'number is put behind its name; none if empty.'),
        Text('state', '', 'File that takes the state after each window, and from which a node that '
             'is started again goes on; none if empty.'),
        Flag('motion', True, 'True to fit the whole tow, hauling and veering too, while it goes '
             'on; otherwise its steady parts are fitted at the end.'),
        Text('truth', '', 'Scenario that made the data, where they are simulated: its coefficients '
             'are compared with the estimate in the report.'),
        *ADVICE_SPECS,
        *WINDOW_SPECS,
    )  # fmt: skip
    DRAINS: ClassVar = True

    def __init__(self, **kwargs: Any) -> None:
        super().__init__('identification_node', **kwargs)
        parameters = self.parameters
        truth, state = parameters['truth'], parameters['state']
        folder = self.new_path('output', or_empty=True)
        known = true_coefficients(truth) if truth else None
        self._state = Path(state) if state else None
        self._gear = load_gear(parameters['gear'])
        identification = self._identification()
        self._motion = self._learning(identification)
        twins = (COEFFICIENTS_BY_NAME, INNOVATIONS_BY_NAME)
        for topic in (ESTIMATE, COVARIANCE, STATUS, INNOVATION, *twins):
            self.advertise(topic)
        self._progress = ConsumerProgress(
            self, idle=lambda: self._worker.idle, busy=lambda: not self._worker.idle
        )
        self._resets = 0
        self._instruments = OneSourceEach()
        self._rewinding = Rewinding(identification.finder.newest('port_length'))
        self._sent: Estimate | None = None
        self._by_windows: Estimate | None = None
        self._telling = Lock()
        self._advice: tuple[Advice | None, str] = None, ''
        # Manoeuvres are proposed for what they tell of boards.
        advised = parameters['advise'] and self._gear.pair is None
        self._adviser = self._advising() if advised else None
        self._worker = IdentificationWorker(
            identification,
            self._publish,
            self._progress.done,
            self._save,
            ReportWriter(self._gear, known, folder, self._motion),
            self._motion,
        )
        # Before any sample it publishes what it knows: nothing yet, or what it goes on from.
        self._publish(self._worker.outcome)
        for topic in SAMPLES:
            self.listen(topic, self._feeder(topic), CONSUMER)
        self.offer_awaiting(FINISH, self._finish)
        self._worker.start()
        if self._adviser is not None:
            self._adviser.start()

    def _advising(self) -> AdviceWorker:
        # A model of its own: the estimator's remembers what it was asked last.
        predictor = predictor_for(self._gear)
        options = window_options(self.parameters)
        adviser = Adviser(self._gear, predictor, advice_limits(self.parameters), options)
        return AdviceWorker(
            adviser,
            board_prior(self._gear).start,
            self.parameters['advise_share'],
            lambda: self._worker.idle and self._progress.stamp > 0,
            self._advised,
        )

    def _learning(self, identification: Identification) -> MotionLearner:
        return MotionLearner(
            self._gear,
            prior=self.parameters['prior'],
            net=self.parameters['net'],
            resumed=bool(identification.estimator.windows),
            steady=not self.parameters['motion'],
        )

    def _identification(self) -> Identification:
        fresh = identification_for(
            self._gear,
            window_options=window_options(self.parameters),
            estimator_options=estimator_options(
                prior=self.parameters['prior'], net=self.parameters['net']
            ),
        )
        if self._state is None or not is_there(self._state, CheckpointError):
            return fresh
        resumed = load_checkpoint(self._state, fresh, self._gear)
        self.get_logger().info(
            f'{self._state}: goes on after {len(resumed.estimator.windows)} windows'
        )
        return resumed

    def statuses(self) -> list[Status]:
        """Return the status of the estimate, or the reason why there is none."""
        self._worker.look()
        outcome = self._worker.outcome
        estimate = outcome.estimate
        values = {
            'samples used until': f'{self._progress.stamp / 1e9:.1f}',
            'resets': str(self._resets),
            'windows': str(estimate.windows if estimate else 0),
            'revision': str(estimate.revision if estimate else 0),
            **{f'rejected {reason}': str(count) for reason, count in outcome.rejected.items()},
        }
        return [
            self._about_estimate(outcome, values),
            motion_diagnosis(self._motion.knowledge),
            *self._about_state(outcome),
            *self._about_advice(),
        ]

    def _about_estimate(self, outcome: EstimatorOutcome, values: dict[str, str]) -> Status:
        level, message = OK, 'estimating'
        if outcome.finished is not None:
            level, message = ERROR if outcome.failed else OK, outcome.finished
        elif trouble := outcome.troubles.get('estimating'):
            level, message = ERROR, trouble
        elif outcome.why_not is not None:
            level, message = WARN, self.with_namespace(outcome.why_not)
        return Status('estimate', level, message, values)

    def _about_state(self, outcome: EstimatorOutcome) -> list[Status]:
        if self._state is None:
            return []
        trouble = outcome.troubles.get('saving')
        windows = str(outcome.estimate.windows if outcome.estimate else 0)
        values = {'file': str(self._state), 'windows': windows}
        message = trouble or 'saved after each window'
        return [Status('state', ERROR if trouble else OK, message, values)]

    def _about_advice(self) -> list[Status]:
        advice, trouble = self._advice
        if self._adviser is None:
            return []
        values = {'looked up': f'{advice.looked_up:.2f}'} if advice else {}
        return [Status('advice', WARN if trouble else OK, trouble or 'advising', values)]

    def finish_work(self) -> None:
        """Bring the estimate to convergence, write the report, and end the thread."""
        if self._adviser is not None:
            self._adviser.stop()
        # A fit of the whole tow takes minutes; whoever ends a node may not wait for it.
        wish = self._worker.finish(whole=False)
        self._worker.stop()
        self._tell(wish.outcome)

    def _feeder(self, topic: str) -> Callable[[Any], None]:
        def feed(message: Any) -> None:
            sample = to_sample(topic, message)
            again, samples = self._rewinding.take(sample)
            if again:
                self._begin_again()
            for one in samples:
                if one is sample:
                    self._instruments.check(topic, sample)
                self._worker.put(one)

        return feed

    def _begin_again(self) -> None:
        self._resets += 1
        self._instruments.forget()
        self._worker.reset()
        self.get_logger().warning('stamps of the winch went back; the estimate begins again')

    def _save(self, identification: Identification) -> None:
        if self._state is not None:
            save_checkpoint(self._state, identification, self._gear)

    def _publish(self, outcome: EstimatorOutcome) -> None:
        told, windows = outcome.told, outcome.estimate
        if told is not None and told is not self._sent:
            self.send(*estimate_message(told.values, told.names))
            self.send(*covariance_message(told.covariance, told.names))
            known = told.values, told.std, told.determined, told.names
            self.send(*coefficients_message(told.stamp, *known))
        new = windows is not self._by_windows
        if windows is not None and new and windows.innovation is not None:
            found = innovations_of(windows.innovation)
            self.send(*innovation_message(windows.stamp, found))
            self.send(*innovations_message(windows.stamp, found))
        self._sent, self._by_windows = told, windows
        self._say_status(outcome)
        if new and self._adviser is not None and outcome.fit is not None:
            self._adviser.fitted(outcome.fit)

    def _advised(self, advice: Advice | None, trouble: str) -> None:
        (before, trouble_before), self._advice = self._advice, (advice, trouble)
        same = str(before) == str(advice) and trouble_before == trouble
        if not same or _ranking(before) != _ranking(advice):
            self._say_status(self._worker.outcome)

    def _say_status(self, outcome: EstimatorOutcome) -> None:
        # Both threads come here, and of two statuses the newer one has to go out last.
        with self._telling:
            statuses = identification_statuses(outcome)
            if self._adviser is not None:
                advice, trouble = self._advice
                windows = outcome.estimate.windows if outcome.estimate else 0
                statuses.append(advice_status(advice, trouble))
                knowledge = replace(knowledge_of(advice, windows), trouble=trouble)
                statuses.append(knowledge_status(knowledge))
            stamp = outcome.told.stamp if outcome.told else outcome.stamp or self.now()
            self.send(STATUS, diagnostic_array(stamp, statuses))

    async def _finish(self, request: Any, response: Any) -> Any:
        wish = self._worker.finish()
        await wish
        response.success = not wish.outcome.failed
        response.message = self._tell(wish.outcome)
        return response

    def _tell(self, outcome: EstimatorOutcome) -> str:
        """Log the sentence with which an identification ends, and return it."""
        finished = outcome.finished or ''
        # A logger refuses another severity from the same line.
        if finished and outcome.failed:
            finished = self.with_namespace(finished)
            self.get_logger().warning(finished)
        elif finished:
            self.get_logger().info(finished)
        return finished


def _ranking(advice: Advice | None) -> tuple[object, ...]:
    return () if advice is None else (advice.windows, advice.looked_up, advice.ranking)


def main(args: Sequence[str] | None = None) -> int:
    """Run the node."""
    return run(IdentificationNode, args)
