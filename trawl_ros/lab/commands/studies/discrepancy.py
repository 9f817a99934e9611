"""``trawl study discrepancy``."""

from pathlib import Path

import click

from trawl_ros.cli.options import (
    FOLDER,
    GEAR_OPTION,
    SCHEDULER_OPTION,
)
from trawl_ros.gear.load import load_gear
from trawl_ros.lab.commands.outcome import print_outcome, stoppable
from trawl_ros.lab.studies.discrepancy.scoring.report import REPORT as DISCREPANCY_REPORT
from trawl_ros.lab.studies.discrepancy.scoring.report import write_discrepancy
from trawl_ros.lab.studies.discrepancy.stages import read_classes, run_blind
from trawl_ros.lab.studies.discrepancy.trials.plan import BlindStudyPlan as DiscrepancyPlan


@click.command('discrepancy')
@click.option('--out', required=True, type=FOLDER, help='Folder of the report and of the trials.')
@click.option('--force', is_flag=True, help='Begin anew, whatever is there.')
@GEAR_OPTION
@click.option('--seed', default=DiscrepancyPlan.seed, show_default=True,
              type=click.IntRange(0, 2**31), help='Of all trials.')  # fmt: skip
@click.option('--clean', default=DiscrepancyPlan.clean, show_default=True,
              type=click.IntRange(0, 10_000), help='Trials with nothing hidden.')  # fmt: skip
@click.option('--inside', default=DiscrepancyPlan.inside, show_default=True,
              type=click.IntRange(0, 1000), help='Trials of each effect of the catalogue '
              'and strength.')  # fmt: skip
@click.option('--outside', default=DiscrepancyPlan.outside, show_default=True,
              type=click.IntRange(0, 1000),
              help='Trials of each other effect and strength.')  # fmt: skip
@click.option('--pairs', default=DiscrepancyPlan.pairs, show_default=True,
              type=click.IntRange(0, 1000), help='Trials of each pair of effects.')  # fmt: skip
@click.option('--poor', default=DiscrepancyPlan.poor, show_default=True,
              type=click.IntRange(0, 1000), help='Trials of a few states, of each effect '
              'that they cannot tell.')  # fmt: skip
@click.option('--deck', default=DiscrepancyPlan.deck, show_default=True,
              type=click.IntRange(0, 1000), help='Trials of each cause on deck and '
              'strength.')  # fmt: skip
@click.option('--triples', default=DiscrepancyPlan.triples, show_default=True,
              type=click.IntRange(0, 1000), help='Trials of each three effects at '
              'once.')  # fmt: skip
@click.option('--dynamic', default=DiscrepancyPlan.dynamic, show_default=True,
              type=click.IntRange(0, 100), help='Trials of a day at sea, in windows and '
              'towed in time.')  # fmt: skip
@click.option('--around', default=DiscrepancyPlan.around, show_default=True,
              type=click.IntRange(12, 96), help='Meshes around the model net.')  # fmt: skip
@click.option('--sample', default=DiscrepancyPlan.sample, show_default=True,
              type=click.IntRange(0, 10_000), help='So many of all these, drawn by chance, without '
              'bags; 0 for all.')  # fmt: skip
@SCHEDULER_OPTION
def command(
    out: Path,
    force: bool,
    gear: str,
    seed: int,
    clean: int,
    inside: int,
    outside: int,
    pairs: int,
    poor: int,
    deck: int,
    triples: int,
    dynamic: int,
    around: int,
    sample: int,
    scheduler: str | None,
) -> None:
    """Hide effects in trials of another plant, and count how often they are found and named.

    Writes discrepancy.json, .md, .html and .png; a target that is missed is part of the report.
    Trials that are in the folder already are not made again: after Ctrl-C the same command goes
    on where it was.
    """
    load_gear(gear)
    plan = DiscrepancyPlan(
        gear, seed, clean, inside, outside, pairs, poor, dynamic, deck, triples, around, sample
    )
    with stoppable(f'the trials made so far are kept in {out}') as (display, _):
        trials = run_blind(plan, out, display, scheduler=scheduler, force=force)
    rows = write_discrepancy(out, plan, trials, read_classes(out))
    print_outcome(rows, out / DISCREPANCY_REPORT)
