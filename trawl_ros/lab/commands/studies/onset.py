"""``trawl study onset``."""

from pathlib import Path
from typing import get_args

import click

from trawl_ros.cli.options import (
    GEAR_OPTION,
    REPORT_OPTION,
)
from trawl_ros.lab.commands.outcome import print_outcome, stoppable
from trawl_ros.lab.studies.onset.known import KnownBy
from trawl_ros.lab.studies.onset.limit import drawn_limit
from trawl_ros.lab.studies.onset.report import ASKED_H, write_onset
from trawl_ros.lab.studies.onset.report import REPORT as ONSET_REPORT
from trawl_ros.lab.studies.onset.study import OnsetPlan, run_onset


@click.command('onset')
@REPORT_OPTION
@GEAR_OPTION
@click.option('--trials', default=OnsetPlan.trials, show_default=True,
              type=click.IntRange(0, 2000), help='Tows in which an effect begins.')  # fmt: skip
@click.option('--clean', default=OnsetPlan.clean, show_default=True,
              type=click.IntRange(0, 2000), help='Tows in which none does.')  # fmt: skip
@click.option('--minutes', default=OnsetPlan.minutes, show_default=True,
              type=click.FloatRange(25.0, 600.0), help='Length of each tow.')  # fmt: skip
@click.option('--seed', default=OnsetPlan.seed, show_default=True, type=click.IntRange(0))
@click.option('--shard', default=(1, 1), show_default=True, type=(int, int),
              help='Make one part of the trials alone, of how many: 1 2.')  # fmt: skip
@click.option('--pictures', is_flag=True,
              help='Draw each tow that is made, as it was watched.')  # fmt: skip
@click.option('--known', default=OnsetPlan.known, show_default=True,
              type=click.Choice(get_args(KnownBy)),
              help='How boards are known when a tow begins: drawn around the truth, or as '
              '`trawl identify` finds them in a tow before.')  # fmt: skip
@click.option('--limit', 'draws', default=0, type=click.IntRange(0, 5000),
              help='Instead: draw the innovations of one clean tow so often, and print the limit '
              'that they exceed once in 230 h.')  # fmt: skip
def command(
    out: Path,
    gear: str,
    trials: int,
    clean: int,
    minutes: float,
    seed: int,
    shard: tuple[int, int],
    pictures: bool,
    known: KnownBy,
    draws: int,
) -> None:
    """Let effects begin during tows, and count how soon they are found, and what is found without.

    Each tow has boards of its own, drawn from the prior of the gear file.

    Writes onset.json, .md and .html. Trials that are in the folder already are not made again, so
    that several shards may share one.
    """
    if draws:
        drawn = drawn_limit(gear, seed, minutes, draws, ASKED_H)
        click.echo(
            f'of {drawn.hours:.0f} h drawn the rarest is {drawn.largest:.2f}; once in '
            f'{ASKED_H:g} h beyond {drawn.limit:.2f}'
        )
        return
    plan = OnsetPlan(gear, trials, clean, minutes, seed, *shard, pictures, known)
    with stoppable(f'the trials made so far are kept in {out}') as (display, _):
        made = run_onset(plan, out, display)
    print_outcome(write_onset(out, plan, made), out / ONSET_REPORT)
