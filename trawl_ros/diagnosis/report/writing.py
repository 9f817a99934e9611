# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Writer of the files of a diagnosis: JSON, reports, figures and the repaired gear file."""

from collections.abc import Iterator, Sequence
from pathlib import Path

from trawl_ros.core.files import made_folder, write_json, write_text
from trawl_ros.diagnosis.diagnosis import Diagnosis
from trawl_ros.diagnosis.holdout import HoldoutComparison
from trawl_ros.diagnosis.repair import SourceBag, gear_text, repaired
from trawl_ros.diagnosis.report.figures import BEGAN, LEAD, drawings
from trawl_ros.diagnosis.report.result import result
from trawl_ros.diagnosis.report.sentences import headline, sentences
from trawl_ros.diagnosis.report.what_to_do import what_to_do
from trawl_ros.estimation.report.sensors import FIELD_UNITS
from trawl_ros.records.channels import CHANNELS
from trawl_ros.report.pictures import by_section, draw, embedded
from trawl_ros.report.rendering import page

MODEL_FILE = 'model.yaml'
"""Name of the gear file with the effect that was found."""


def write_diagnosis(diagnosis: Diagnosis, sources: Sequence[SourceBag], folder: Path) -> None:
    """Write ``diagnosis.json``, both reports and the figures, and ``model.yaml`` after a repair.

    Parameters
    ----------
    diagnosis
        The diagnosis.
    sources
        Bags of the diagnosis.
    folder
        Folder of the files; it is created if it does not exist.

    Raises
    ------
    TrawlError
        If the folder cannot be written to.
    """
    numbers = result(diagnosis, sources)
    gear = repaired(diagnosis, sources)
    made_folder(folder)
    write_json(folder / 'diagnosis.json', numbers, indent=2)
    if gear is not None:
        write_text(folder / MODEL_FILE, gear_text(gear))
    sections = by_section(embedded(folder, draw(folder, drawings(diagnosis))))
    # The template shows these two sections in places of their own.
    lead, began = sections.pop(LEAD, []), sections.pop(BEGAN, [])
    for name in ('report.html', 'report.md'):
        text = page(
            'trawl_ros.diagnosis.report',
            name,
            result={**numbers, 'gear': diagnosis.gear.name},
            headline=' '.join(filter(None, (headline(diagnosis), _gain(diagnosis)))),
            sentences=sentences(diagnosis),
            what_to_do=what_to_do(diagnosis),
            errors=[] if diagnosis.holdout is None else list(_error_rows(diagnosis.holdout)),
            pictures=lead,
            began=began,
            sections=sections,
            repaired=gear is not None,
        )
        write_text(folder / name, text)


def _gain(diagnosis: Diagnosis) -> str:
    """Return a sentence on how much the named cause reduces the worst sensor's held-out error.

    The worst sensor has the largest ratio of RMS to expected error before the repair.
    """
    holdout = diagnosis.holdout
    if diagnosis.verdict not in ('NAMED', 'AMBIGUOUS') or holdout is None or holdout.after is None:
        return ''
    before, after = holdout.before, holdout.after.rms
    worst = max(after, key=lambda name: before.rms[name] / before.expected[name])
    unit, factor = FIELD_UNITS[CHANNELS[worst].unit]
    return (
        f'With it the error of {worst.replace("_", " ")} on held-out tows falls from '
        f'{factor * before.rms[worst]:.2f} to {factor * after[worst]:.2f} {unit}.'
    )


def _error_rows(holdout: HoldoutComparison) -> Iterator[tuple[str, ...]]:
    """Yield a row of cells for each sensor, with errors on held-out tows in field units.

    The cells are its name, and the errors as expected, without the cause, with it, and with the
    best wrong cause (``placebo``).
    """
    with_cause, with_placebo = (one.rms if one else {} for one in (holdout.after, holdout.placebo))
    for name, before in holdout.before.rms.items():
        unit, factor = FIELD_UNITS[CHANNELS[name].unit]
        expected = holdout.before.expected[name]
        errors = expected, before, with_cause.get(name), with_placebo.get(name)
        space = '' if unit == '°' else ' '
        cells = ('–' if error is None else f'{factor * error:.2f}{space}{unit}' for error in errors)
        yield name.replace('_', ' '), *cells
