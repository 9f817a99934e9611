"""The last act of the demo: something is hidden in a trial, found, named, and repaired."""

from pathlib import Path

import click
from rich.console import Console
from rich.table import Table

from trawl_ros.diagnosis.diagnosis import Diagnosis, diagnose
from trawl_ros.diagnosis.words import headline, sentences
from trawl_ros.diagnosis.writing import MODEL, write_diagnosis
from trawl_ros.errors import TrawlError
from trawl_ros.files import write_json
from trawl_ros.gear.load import load_gear
from trawl_ros.identification.channels import CHANNELS
from trawl_ros.studies.discrepancy.study import FINER
from trawl_ros.studies.discrepancy.trials.making import make
from trawl_ros.studies.discrepancy.trials.tows import FULL
from trawl_ros.studies.discrepancy.trials.trial import Spec

HIDDEN = Spec('inside', 0, ('current_shear',), 5.0, (1.0,), plant=1)
"""A curved shear, which is not the form that the catalogue gives it."""

SEED = 6


def hidden_effect(folder: Path, console: Console) -> None:
    """Hide an effect in a trial of a finer plant, diagnose it, and again with the repair.

    Writes the reports into ``folder``, and prints both verdicts.
    """
    # The name of its gear is that of the plan, whatever the demo has towed.
    gear = 'kaifuha'
    with console.status('hiding an effect in a trial of a finer gear'):
        key, made = make(HIDDEN, gear, FINER, SEED)
    if made is None:
        raise TrawlError(f'{folder}: no trial could be made: {key.why_not}')
    tows = [f'tow {number + 1}' for number in range(len(FULL.tows))]
    baseline = frozenset(range(FULL.baseline))
    with console.status('diagnosing it') as status:
        found = diagnose(FINER.model(gear), made.windows, tows, baseline, status.update)
        write_diagnosis(found, (), folder)
        again = None
        if found.repair is not None:
            repaired = load_gear(folder / MODEL)
            again = diagnose(repaired, made.windows, tows, baseline, status.update)
    write_json(folder / 'key.json', key.record(), indent=2)
    _print(found, again)
    click.echo(f'{folder}: report.html, {MODEL}, and key.json, which the diagnosis has not seen')


def _print(found: Diagnosis, again: Diagnosis | None) -> None:
    console = Console(highlight=False, soft_wrap=True)
    hidden = HIDDEN.effects[0].replace('_', ' ')
    console.print(
        f'A trial of {len(FULL.tows)} tows in which {hidden} is hidden. {found.verdict}. '
        f'{headline(found)}',
        markup=False,
    )
    for sentence in sentences(found):
        console.print(sentence, markup=False)
    if found.shown is not None and found.shown.after is not None:
        table = Table(title='Errors on tows that decided nothing, in those of the instruments')
        table.add_column('', style='bold')
        for heading in ('before', 'after'):
            table.add_column(heading, justify='right')
        before, after = found.shown.before, found.shown.after
        for name, expected in before.expected.items():
            if name in CHANNELS:
                ratios = (part.rms[name] / expected for part in (before, after))
                table.add_row(name.replace('_', ' '), *(f'{ratio:.2f}' for ratio in ratios))
        console.print(table)
    if again is not None:
        console.print(
            f'With the repaired gear, of the same tows: {again.verdict}. {headline(again)}',
            markup=False,
        )
