# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``trawl missing-effect``: make blind trials, answer them, and score answers."""

from collections.abc import Sequence
from pathlib import Path

import click

from trawl_ros.cli.console.tables import output_console, plain_table
from trawl_ros.cli.options import FILE, FOLDER, FORCE_OPTION, GEAR_OPTION
from trawl_ros.core.errors import TrawlError
from trawl_ros.core.files import empty_folder
from trawl_ros.lab.commands.outcome import stoppable
from trawl_ros.lab.missing_effect.answering import METHODS, answer_trials
from trawl_ros.lab.missing_effect.score_report import cases_of, comparison_table, write_score
from trawl_ros.lab.missing_effect.trials_folder import (
    key_file,
    make_trials,
    read_answers,
    read_key,
    read_trials,
)
from trawl_ros.lab.trials.trial import Form

FORMS = ('windows', 'bags', 'dynamic')


@click.group('missing-effect')
def command() -> None:
    """Make blind trials of a missing effect, answer them, and score answers of any program."""


@command.command('make')
@click.argument('out', type=FOLDER)
@click.option('--seed', required=True, type=click.IntRange(0), help='Seed of all draws.')
@click.option('--trials', required=True, type=click.IntRange(1, 10_000), help='Number of trials.')
@GEAR_OPTION
@click.option(
    '--form', type=click.Choice(FORMS), default='windows', show_default=True,
    help='Steady windows of linearised states; bags of such states; bags of tows in time.',
)  # fmt: skip
def make(out: Path, seed: int, trials: int, gear: str, form: Form) -> None:
    """Make blind trials in the folder OUT.

    Their key is a file next to OUT. A call with more trials goes on where an earlier one ended.
    """
    with stoppable(f'the trials made so far are in {out}') as (display, _):
        key = make_trials(out, seed=seed, trials=trials, gear=gear, form=form, on_progress=display)
    click.echo(
        f'{out}: {len(key.trials)} trials; {len(key.not_possible)} draws were not possible; '
        f'key: {key_file(out)}'
    )


@command.command('answer')
@click.argument('folder', type=FOLDER)
@click.option('--out', required=True, type=FOLDER, help='Folder of the answers.')
@click.option(
    '--method', 'methods', multiple=True, type=click.Choice(METHODS),
    help='Method. May be given several times; all by default.',
)  # fmt: skip
def answer(folder: Path, out: Path, methods: Sequence[str]) -> None:
    """Answer the trials in FOLDER.

    Methods are the diagnosis of the project and baselines. A call goes on where an earlier one
    ended.
    """
    chosen = tuple(dict.fromkeys(methods)) or METHODS
    with stoppable(f'the answers so far are in {out}') as (display, _):
        answer_trials(folder, out, chosen, display)
    for name in chosen:
        click.echo(out / f'{name}.json')


@command.command('score')
@click.argument('folder', type=FOLDER)
@click.argument('answers', nargs=-1, required=True, type=FILE)
@click.option('--key', type=FILE, help='Key of the trials; by default the file next to FOLDER.')
@click.option('--out', type=FOLDER, help='Folder of a report on the first file of ANSWERS.')
@FORCE_OPTION
def score(
    folder: Path, answers: Sequence[Path], key: Path | None, out: Path | None, force: bool
) -> None:
    """Score ANSWERS, files of answers to the trials in FOLDER.

    The command prints a column for each file.
    """
    if out is not None:
        empty_folder(out, force=force)
    trials, truth = read_trials(folder), read_key(folder, key)
    methods = {}
    for path in dict.fromkeys(answers):
        own = read_answers(path, trials)
        if own.method in methods:
            raise TrawlError(
                f'{path}: method: found {own.method} again, expected a name that no other file has'
            )
        methods[own.method] = cases_of(truth, own)
    table = comparison_table(methods)
    shown = plain_table(*table.head, wrapped=('what',))
    for row in table.rows:
        shown.add_row(*row)
    output_console().print(shown)
    if out is not None:
        files = ' '.join(str(path) for path in answers)
        write_score(out, f'trawl missing-effect score {folder} {files}', truth, methods)
        click.echo(out / 'missing_effect.html')
