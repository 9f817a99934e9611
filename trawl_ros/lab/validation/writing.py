"""Validation report as JSON, Markdown and HTML."""

from collections.abc import Sequence
from pathlib import Path

from trawl_ros.core.files import write_json, write_text
from trawl_ros.core.version import __version__
from trawl_ros.lab.report.check import Check
from trawl_ros.lab.validation.cases import NAMES, TITLES
from trawl_ros.lab.validation.run import Finished
from trawl_ros.report.rendering import number, page

JSON, REPORTS = 'validation.json', ('report.html', 'report.md')


def write_report(folder: Path, finished: Sequence[Finished], *, small: bool) -> None:
    """Write ``validation.json``, ``report.html`` and ``report.md`` into a folder."""
    ordered = sorted(finished, key=lambda case: NAMES.index(case.name))
    figures = {
        f'{case.name}.{check.key}': check_record(check) for case in ordered for check in case.checks
    }
    write_json(folder / JSON, figures, indent=1, ensure_ascii=False)
    sections = [
        (title, [case for case in ordered if case.section == section])
        for section, title in TITLES.items()
    ]
    for name in REPORTS:
        text = page(
            'trawl_ros.lab.validation',
            name,
            expectation=expectation,
            sections=[(title, cases) for title, cases in sections if cases],
            passed=sum(check.ok for case in ordered for check in case.checks),
            total=sum(len(case.checks) for case in ordered),
            failing=[(case, check) for case in ordered for check in case.checks if not check.ok],
            small=small,
            version=__version__,
        )
        write_text(folder / name, text)


def check_record(check: Check) -> dict[str, object]:
    """One check as plain values; what could not be measured is null."""
    expected = check.expected
    return {
        'what': check.what,
        'measured': check.measured if check.measured == check.measured else None,
        'expected': list(expected) if isinstance(expected, tuple) else expected,
        'tolerance': check.tolerance,
        'rule': check.rule,
        'unit': check.unit,
        'ok': bool(check.ok),
        'note': check.note,
    }


def expectation(check: Check) -> str:
    """Target of a check in symbols."""
    unit = f' {check.unit}' if check.unit else ''
    if isinstance(check.expected, tuple):
        low, high = check.expected
        return f'{number(low)} to {number(high)}{unit}'
    text = f'{number(check.expected)}{unit}'
    if check.rule == 'at_most':
        return f'≤ {text}'
    if check.rule == 'at_least':
        return f'≥ {text}'
    if check.rule == 'relative':
        return f'{text} ± {number(100 * check.tolerance)} %'
    return f'{text} ± {number(check.tolerance)}' if check.tolerance else text
