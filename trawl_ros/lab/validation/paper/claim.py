# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Claim of section IV with the model's checks of it."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from trawl_ros.lab.report.measured import MeasuredValue
from trawl_ros.lab.report.page import TextTable


@dataclass(frozen=True)
class Claim:
    """Claim: one sentence with its checks.

    Attributes
    ----------
    where
        Section and figures it speaks of.
    says
        Text of the claim, shortened.
    checks
        Each of its parts that can be measured.
    """

    where: str
    says: str
    checks: tuple[MeasuredValue, ...]

    @property
    def agrees(self) -> str:
        """Agreement of the model in words: yes, no, or in part."""
        held = sum(check.ok for check in self.checks)
        return 'yes' if held == len(self.checks) else 'in part' if held else 'no'


def claim(where: str, says: str, *checks: MeasuredValue) -> Claim:
    """Make a claim; its checks that hold are noted with the place in the paper."""
    noted = tuple(
        replace(check, note=f'Section {where}: {says}.') if check.ok else check for check in checks
    )
    return Claim(where, says, noted)


def claim_table(claims: Sequence[Claim]) -> TextTable:
    """Table of all claims."""
    rows = []
    for one in claims:
        gives = '; '.join(f'{check.what}: {check.figure} ({check.wanted})' for check in one.checks)
        reasons = dict.fromkeys(check.note for check in one.checks if not check.ok)
        rows.append((one.where, one.says, gives, one.agrees, ' '.join(reasons)))
    return TextTable(
        'What section IV claims, shortened, and what this model gives (in brackets what the '
        'sentence leads one to expect).',
        ('section', 'the paper', 'this model', 'agrees', 'why not'),
        tuple(rows),
    )
