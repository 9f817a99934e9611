# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The diagnosis of the project as a method of the benchmark."""

from trawl_ros.diagnosis.diagnosis import Diagnosis
from trawl_ros.diagnosis.procedure import diagnose_windows
from trawl_ros.lab.missing_effect.methods.shared import answer, with_repair
from trawl_ros.lab.missing_effect.records import AnswerRecord
from trawl_ros.lab.missing_effect.trials_folder import TrialInput


def trawl_diagnose(data: TrialInput) -> AnswerRecord:
    """Diagnose a trial in the same way as `trawl diagnose`."""
    return answer_of(diagnose_windows(data.gear, data.windows, data.tows, data.baseline))


def answer_of(found: Diagnosis) -> AnswerRecord:
    """Return a diagnosis as an answer."""
    if found.posterior is None:
        return AnswerRecord(verdict='NOT_TESTABLE')
    # A frozen sensor is named without a place in the library: no trial hides one.
    verdict = 'UNKNOWN' if found.verdict == 'NAMED' and not found.named else found.verdict
    made = answer(found.posterior, verdict, found.named, found.among, found.best)
    if found.repair is None or found.repair.refit is None or found.base is None:
        return made
    return with_repair(made, found.holdout, found.base, found.repair.refit)
