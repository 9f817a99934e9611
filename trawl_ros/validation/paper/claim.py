"""A sentence of section IV beside what this model gives."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from trawl_ros.reporting import number
from trawl_ros.validation.check import Check, Rule, Table
from trawl_ros.validation.writing import expectation

Expected = float | tuple[float, float]


@dataclass(frozen=True)
class Claim:
    """One sentence.

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
        """Whether the model agrees: yes, no, or in part."""
        held = sum(check.ok for check in self.checks)
        return 'yes' if held == len(self.checks) else 'in part' if held else '**no**'


def claim(where: str, says: str, *checks: Check) -> Claim:
    """A sentence; the checks that hold are noted with where it stands in the paper."""
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
    """One measurable part of a sentence; ``reason`` is told when it does not hold."""
    if isinstance(expected, tuple):
        rule = 'between'
    return Check(key, what, float(measured), expected, tolerance, rule, unit, reason)


def claim_table(claims: Sequence[Claim]) -> Table:
    """All sentences as a table."""
    rows = []
    for one in claims:
        gives = '; '.join(
            f'{check.what}: {number(check.measured)} {check.unit}'.rstrip()
            + f' ({expectation(check)})'
            for check in one.checks
        )
        reasons = dict.fromkeys(check.note for check in one.checks if not check.ok)
        rows.append((one.where, one.says, gives, one.agrees, ' '.join(reasons)))
    return Table(
        'What section IV claims, shortened, and what this model gives (in brackets what the '
        'sentence leads one to expect).',
        ('section', 'the paper', 'this model', 'agrees', 'why not'),
        tuple(rows),
    )
