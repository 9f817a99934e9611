# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The diagnosis of the project as a method of the benchmark."""

from trawl_ros.diagnosis.diagnosis import Diagnosis
from trawl_ros.diagnosis.procedure import diagnose_windows
from trawl_ros.lab.missing_effect.methods.shared import answer, coefficients, held_out
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
    if found.repair is None:
        return made
    repair = coefficients(found.base, found.repair.refit)
    return made.model_copy(update={'held_out': held_out(found.holdout), 'coefficients': repair})
