"""Report of the study of sailed trials: JSON, Markdown and HTML."""

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

import numpy as np
from scipy.stats import t

from trawl_ros.lab.report.measured import MeasuredValue, at_most
from trawl_ros.lab.report.page import Page, Section, TextTable, write_page
from trawl_ros.lab.studies.sailing.courses import Course
from trawl_ros.lab.studies.sailing.study import SailedBoard, SailingPlan

REPORT = 'sailing.md'

INTERVAL = 'Geometric mean over {number} boards; 95 % interval by Student, of the logarithms.'


def write_sailing(
    folder: Path, plan: SailingPlan, boards: Sequence[SailedBoard]
) -> list[MeasuredValue]:
    """Write ``sailing.json``, ``.md`` and ``.html`` into a folder; return all rows."""
    page = Page(
        name='sailing',
        title='Trials that run themselves',
        command=f'trawl study sailing --boards {plan.boards} --around {plan.around} '
        f'--hours {plan.hours:g} --seed {plan.seed}',
        method=f'Random boards, each towed for {plan.hours:g} h on four courses: by the choice of '
        'a trial that runs itself, as planned beforehand with the board as identification starts, '
        "in the paper's sweep, and as it would be planned if the board were known. Plant and model "
        'are the same; two windows in each state, as instruments would give them, with calibration '
        'errors that stay through the tow. Time is that of the planner; a state in which the board '
        'cannot be towed costs it and gives nothing. What counts is the geometric mean of the std '
        'of the twelve coefficients.',
    )
    rows = [
        _ratio('sailed over planned', [board.over_plan for board in boards], 0.8, 'over_plan'),
        _ratio('sailed over sweep', [board.over_sweep for board in boards], 0.4, 'over_sweep'),
        _ratio(
            'planned with the board known over planned',
            [board.known_over_plan for board in boards],
            None,
            'known_over_plan',
        ),
    ]
    table = TextTable(
        'Courses: states towed, states in which the board cannot be towed, hours, mean std',
        ('board', 'course', 'towed', 'not towable', 'hours', 'mean std'),
        tuple(
            (str(board.number), name, *_row(course))
            for board in boards
            for name, course in (
                ('sailed', board.sailed),
                ('planned', board.planned),
                ('sweep', board.sweep),
                ('board known', board.known),
            )
        ),
    )
    record = {
        'rows': [row.record() for row in rows],
        'plan': asdict(plan),
        'boards': [_record(board) for board in boards],
    }
    return write_page(folder, page, [Section('Mean std', rows, tables=[table])], record=record)


def _ratio(what: str, ratios: Sequence[float], most: float | None, key: str) -> MeasuredValue:
    logs = np.log(ratios)
    middle = float(np.exp(np.mean(logs)))
    low = high = float('nan')
    if len(logs) > 1:
        half = float(t.ppf(0.975, len(logs) - 1) * np.std(logs, ddof=1) / np.sqrt(len(logs)))
        low, high = middle * np.exp(-half), middle * np.exp(half)
    target = None if most is None else at_most(most)
    note = INTERVAL.format(number=len(logs))
    return MeasuredValue(f'mean std, {what}', middle, '', target, note, low, high, key)


def _row(course: Course) -> tuple[str, ...]:
    numbers = (len(course.states), course.refused)
    return (*map(str, numbers), f'{course.hours:.2f}', f'{course.mean_std:.4f}')


def _record(board: SailedBoard) -> dict[str, object]:
    courses = {
        'sailed': board.sailed, 'planned': board.planned, 'sweep': board.sweep,
        'known': board.known,
    }  # fmt: skip
    return {
        'number': board.number,
        'coefficients': board.coefficients,
        **{
            name: {**asdict(course), 'std': course.std.tolist(), 'mean_std': course.mean_std}
            for name, course in courses.items()
        },
    }
