"""Claim of section IV with the model's checks of it."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from trawl_ros.lab.report.check import Check, Rule, TextTable
from trawl_ros.lab.validation.writing import expectation
from trawl_ros.report.rendering import number

Expected = float | tuple[float, float]


@dataclass(frozen=True)
class Claim:
    """Claim: one sentence with its checks.

    Attributes
    ----------
    where
        Section and figures it speaks of.
    says
        What it says, shortened.
    checks
        Each of its parts that can be measured.
    """

    where: str
    says: str
    checks: tuple[Check, ...]

    @property
    def agrees(self) -> str:
        """Agreement of the model in words: yes, no, or in part."""
        held = sum(check.ok for check in self.checks)
        return 'yes' if held == len(self.checks) else 'in part' if held else '**no**'


def claim(where: str, says: str, *checks: Check) -> Claim:
    """Make a claim; its checks that hold are noted with the place in the paper."""
    noted = tuple(
        replace(check, note=f'Section {where}: {says}.') if check.ok else check for check in checks
    )
    return Claim(where, says, noted)


def part(
    key: str,
    what: str,
    measured: float,
    expected: Expected,
    reason: str,
    *,
    rule: Rule = 'at_least',
    unit: str = '',
    tolerance: float = 0.0,
) -> Check:
    """Make the check of a measurable part; ``reason`` is told when it does not hold."""
    if isinstance(expected, tuple):
        rule = 'between'
    return Check(key, what, float(measured), expected, tolerance, rule, unit, reason)


def claim_table(claims: Sequence[Claim]) -> TextTable:
    """Table of all claims."""
    rows = []
    for one in claims:
        gives = '; '.join(
            f'{check.what}: {number(check.measured)} {check.unit}'.rstrip()
            + f' ({expectation(check)})'
            for check in one.checks
        )
        reasons = dict.fromkeys(check.note for check in one.checks if not check.ok)
        rows.append((one.where, one.says, gives, one.agrees, ' '.join(reasons)))
    return TextTable(
        'What section IV claims, shortened, and what this model gives (in brackets what the '
        'sentence leads one to expect).',
        ('section', 'the paper', 'this model', 'agrees', 'why not'),
        tuple(rows),
    )
