"""``trawl study``: what takes long to find out, measured and reported."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import click

from trawl_ros.cli.interruption import INTERRUPTED, Interruption
from trawl_ros.cli.options import (
    FILE,
    FOLDER,
    FORCE_OPTION,
    GEAR_OPTION,
    REPORT_OPTION,
    SCHEDULER_OPTION,
)
from trawl_ros.cli.progress import ProgressDisplay, error_console
from trawl_ros.core.errors import RosMissing
from trawl_ros.core.files import empty_folder, made_folder
from trawl_ros.core.progress import WorkProgress
from trawl_ros.gear.load import load_gear
from trawl_ros.instruments.parameters import load_instruments
from trawl_ros.lab.commands.outcome import print_outcome, stoppable
from trawl_ros.lab.studies.chaos.plan import Plan as ChaosPlan
from trawl_ros.lab.studies.chaos.report import REPORT as CHAOS_REPORT
from trawl_ros.lab.studies.chaos.report import write_chaos
from trawl_ros.lab.studies.chaos.study import run_chaos
from trawl_ros.lab.studies.counters.study import REPORT as COUNTERS_REPORT
from trawl_ros.lab.studies.counters.study import SEED as COUNTERS_SEED
from trawl_ros.lab.studies.counters.study import read_table, run_counters
from trawl_ros.lab.studies.discrepancy.scoring.report import REPORT as DISCREPANCY_REPORT
from trawl_ros.lab.studies.discrepancy.scoring.report import write_discrepancy
from trawl_ros.lab.studies.discrepancy.stages import read_classes, run_blind
from trawl_ros.lab.studies.discrepancy.trials.plan import BlindStudyPlan as DiscrepancyPlan
from trawl_ros.lab.studies.flume.states import read_states
from trawl_ros.lab.studies.flume.study import REPORT as FLUME_REPORT
from trawl_ros.lab.studies.flume.study import run_flume
from trawl_ros.lab.studies.identification.report import REPORT as IDENTIFICATION_REPORT
from trawl_ros.lab.studies.identification.report import write_identification
from trawl_ros.lab.studies.identification.study import EstimationStudyPlan as IdentificationPlan
from trawl_ros.lab.studies.identification.study import run_study
from trawl_ros.lab.studies.instruments.calibrations import read_calibrations
from trawl_ros.lab.studies.instruments.report import REPORT as INSTRUMENTS_REPORT
from trawl_ros.lab.studies.instruments.report import FurtherTables, write_instruments
from trawl_ros.lab.studies.instruments.study import SEED as INSTRUMENTS_SEED
from trawl_ros.lab.studies.instruments.study import run_instruments
from trawl_ros.lab.studies.instruments.wire_steps import read_steps
from trawl_ros.lab.studies.motion.study import REPORT as MOTION_REPORT
from trawl_ros.lab.studies.motion.study import MotionStudyPlan, run_motion_study
from trawl_ros.lab.studies.onset.limit import drawn_limit
from trawl_ros.lab.studies.onset.report import ASKED_H, write_onset
from trawl_ros.lab.studies.onset.report import REPORT as ONSET_REPORT
from trawl_ros.lab.studies.onset.study import OnsetPlan, run_onset
from trawl_ros.lab.studies.robustness.report import REPORT as ROBUSTNESS_REPORT
from trawl_ros.lab.studies.robustness.report import write_robustness
from trawl_ros.lab.studies.robustness.study import LENGTHS, RobustnessPlan, run_robustness
from trawl_ros.lab.studies.sailing.report import REPORT as SAILING_REPORT
from trawl_ros.lab.studies.sailing.report import write_sailing
from trawl_ros.lab.studies.sailing.study import SailingPlan, run_sailing
from trawl_ros.lab.studies.soak.report import REPORT, write_soak
from trawl_ros.lab.studies.soak.study import SoakPlan, run_soak
from trawl_ros.lab.studies.sonar.report import REPORT as SONAR_REPORT
from trawl_ros.lab.studies.sonar.report import write_sonar
from trawl_ros.lab.studies.sonar.study import CASES, SonarStudy


@click.group('study')
def command() -> None:
    """Measure what takes long to find out, and report it."""


@command.command('soak')
@REPORT_OPTION
@FORCE_OPTION
@click.option(
    '--hours',
    default=24.0,
    show_default=True,
    type=click.FloatRange(0.005, 48.0),
    help='Time at sea, towed as fast as it goes.',
)
@GEAR_OPTION
@click.option('--real-time-s', default=60.0, show_default=True, type=click.FloatRange(0.0, 3600.0),
              help='Wall time in real time, for the share of a core; 0 leaves it out.')  # fmt: skip
@click.option('--coarse', is_flag=True, help='Tow at sea with a coarse net, which is quicker.')
def soak(out: Path, force: bool, hours: float, gear: str, real_time_s: float, coarse: bool) -> None:
    """Tow for a day through the ROS graph, and watch memory, delay and processor time.

    Every node is a process of its own. Writes soak.json, .md, .html and .png; a target that
    is missed is part of the report. Ctrl-C ends the tow early, and the report says so.
    """
    load_gear(gear)
    plan = SoakPlan(hours, gear, real_time_s, coarse=coarse)
    empty_folder(out, force=force)
    with _until_stopped() as stopped:
        with ProgressDisplay(error_console()) as display:
            rows = write_soak(out, run_soak(plan, out, display, stopped))
        print_outcome(rows, out / REPORT)


@command.command('chaos')
@REPORT_OPTION
@FORCE_OPTION
@click.option('--hours', default=ChaosPlan.hours, show_default=True,
              type=click.FloatRange(0.02, 24.0), help='Time at sea, towed twice.')  # fmt: skip
@click.option('--kills', default=ChaosPlan.kills, show_default=True,
              type=click.IntRange(0, 1000), help='Of the recorder at full load.')  # fmt: skip
@click.option('--seed', default=ChaosPlan.seed, show_default=True,
              type=click.IntRange(0, 2**31), help='Of what happens when.')  # fmt: skip
@GEAR_OPTION
def chaos(out: Path, force: bool, hours: float, kills: int, seed: int, gear: str) -> None:
    """Stop and kill nodes, crowd their topics, fill the disk, and see what is left of a tow.

    Every node is a process of its own. Writes chaos.json, .md, .html and .png; a target that is
    missed is part of the report. Ctrl-C ends it early, and the report says so.
    """
    load_gear(gear)
    plan = ChaosPlan(hours, kills, seed, gear)
    empty_folder(out, force=force)
    with _until_stopped() as stopped:
        with ProgressDisplay(error_console()) as display:
            rows = write_chaos(out, run_chaos(plan, out, display, stopped))
        print_outcome(rows, out / CHAOS_REPORT)


@command.command('sonar')
@REPORT_OPTION
@FORCE_OPTION
@click.option('--sweeps', default=130, show_default=True, type=click.IntRange(2, 10_000),
              help='Sweeps of each case.')  # fmt: skip
@GEAR_OPTION
@click.option('--instruments', default='default', show_default=True,
              help='File or name of instrument parameters.')  # fmt: skip
def sonar(out: Path, force: bool, sweeps: int, gear: str, instruments: str) -> None:
    """Set the openings that are read off the trawl sonar's image beside the truth.

    Over several states of the gear, and with fish and the seabed in view. Writes sonar.json,
    .md, .html and .png.
    """
    study = SonarStudy(sweeps, gear=gear, instruments=instruments)
    empty_folder(out, force=force)
    measured = []
    with stoppable() as (display, _):
        for done, case in enumerate(CASES):
            display(WorkProgress('measuring', done, len(CASES), 'cases', case.name))
            measured.append(study.measure(case))
    write_sonar(out, measured, sweeps)
    click.echo(f'{sweeps} sweeps of each of {len(CASES)} cases: {out / SONAR_REPORT}')


@command.command('identification')
@click.option('--out', required=True, type=FOLDER, help='Folder of the report and of the trials.')
@click.option('--force', is_flag=True, help='Begin anew, whatever is there.')
@GEAR_OPTION
@click.option('--seed', default=IdentificationPlan.seed, show_default=True,
              type=click.IntRange(0, 2**31), help='Of all trials.')  # fmt: skip
@click.option('--coverage', default=IdentificationPlan.coverage, show_default=True,
              type=click.IntRange(1, 10_000), help='Trials with a finer plant.')  # fmt: skip
@click.option('--bound', default=IdentificationPlan.bound, show_default=True,
              type=click.IntRange(0, 10_000), help='Trials with the model as plant.')  # fmt: skip
@click.option('--mouth', default=IdentificationPlan.mouth, show_default=True,
              type=click.IntRange(0, 10_000), help='Trials with a finer mouth.')  # fmt: skip
@click.option('--around', default=IdentificationPlan.around, show_default=True,
              type=click.IntRange(12, 96), help='Meshes around the model net.')  # fmt: skip
@click.option('--tows', default=IdentificationPlan.tows, show_default=True,
              type=click.IntRange(1, IdentificationPlan.tows), help='In a trial.')  # fmt: skip
@SCHEDULER_OPTION
@click.option('--small', is_flag=True, help='Trials only: neither a planned trial, nor a replay, '
              'nor the node in real time.')  # fmt: skip
@click.option('--live-s', default=IdentificationPlan.live_s, show_default=True,
              type=click.FloatRange(0.0, 3600.0),
              help='Wall time of the node in real time; 0 leaves it out.')  # fmt: skip
def identification(
    out: Path,
    force: bool,
    gear: str,
    seed: int,
    coverage: int,
    bound: int,
    mouth: int,
    around: int,
    tows: int,
    scheduler: str | None,
    small: bool,
    live_s: float,
) -> None:
    """Ask of many trials what the intervals and predictions of identification are worth.

    Writes identification.json, .md, .html and .png; a target that is missed is part of the
    report. Trials that are in the folder already are not made again: after
    Ctrl-C the same command goes on where it was.
    """
    plan = IdentificationPlan(gear, seed, coverage, bound, mouth, around, tows, live_s)
    with stoppable(f'the trials made so far are kept in {out}') as (display, _):
        found = run_study(plan, out, display, scheduler=scheduler, force=force, small=small)
    rows = write_identification(out, plan, found.sections, found.figure)
    print_outcome(rows, out / IDENTIFICATION_REPORT)


@command.command('motion')
@click.option('--out', required=True, type=FOLDER, help='Folder of the report and of the trials.')
@click.option('--force', is_flag=True, help='Begin anew, whatever is there.')
@GEAR_OPTION
@click.option('--seed', default=MotionStudyPlan.seed, show_default=True,
              type=click.IntRange(0, 2**31), help='Of all trials.')  # fmt: skip
@click.option('--trials', default=MotionStudyPlan.trials, show_default=True,
              type=click.IntRange(1, 10_000), help='Trials with a finer plant.')  # fmt: skip
@click.option('--alike', default=MotionStudyPlan.alike, show_default=True,
              type=click.IntRange(0, 10_000), help='Trials with the model as plant.')  # fmt: skip
@click.option('--around', default=MotionStudyPlan.around, show_default=True,
              type=click.IntRange(12, 96), help='Meshes around the model net.')  # fmt: skip
@SCHEDULER_OPTION
def motion(
    out: Path,
    force: bool,
    gear: str,
    seed: int,
    trials: int,
    alike: int,
    around: int,
    scheduler: str | None,
) -> None:
    """Ask of tows in time what a fit of all of each is worth, beside that of its windows.

    Writes motion.json, .md and .html; a target that is missed is part of the report. Trials that
    are in the folder already are not made again: after Ctrl-C the same command goes on where it
    was.
    """
    plan = MotionStudyPlan(gear, seed, trials, alike, around)
    with stoppable(f'the trials made so far are kept in {out}') as (display, _):
        rows = run_motion_study(plan, out, display, scheduler=scheduler, force=force)
    print_outcome(rows, out / MOTION_REPORT)


@command.command('instruments')
@click.option('--table', 'table', type=FILE, required=True,
              help='Readings of a survey, CSV packed by gzip: HAUL, t, CABINET_SENSOR_FLAG, VALUE, '
              'DATUM_CODE.')  # fmt: skip
@click.option('--beside', type=FOLDER,
              help='Folder with further tables: a sea experiment with stepped lengths of wire, '
              'counters beside marks on the wire, and distances on a dock.')  # fmt: skip
@click.option('--instruments', default='default', show_default=True,
              help='File or name of instrument parameters.')  # fmt: skip
@REPORT_OPTION
@click.option('--seed', default=INSTRUMENTS_SEED, show_default=True,
              type=click.IntRange(0, 2**31), help='Of the simulated readings.')  # fmt: skip
@FORCE_OPTION
def instruments(
    table: Path, beside: Path | None, instruments: str, out: Path, seed: int, force: bool
) -> None:
    """Set simulated range sensors beside those of a survey, haul by haul.

    Writes instruments.json, .md, .html and figures; a target that is missed is part of the report.
    """
    ship = load_instruments(instruments)
    further = (
        None if beside is None else FurtherTables(read_steps(beside), read_calibrations(beside))
    )
    empty_folder(out, force=force)
    with stoppable() as (display, _):
        found = run_instruments(table, ship, display, seed)
    rows = write_instruments(out, found, instruments, seed, further)
    print_outcome(rows, out / INSTRUMENTS_REPORT)


@command.command('counters')
@click.option('--table', required=True, type=FILE, help='CSV of true wire and what both counters '
              'showed, in fathoms: wire_out_fm, winch_stbd_fm, winch_port_fm.')  # fmt: skip
@REPORT_OPTION
@click.option('--seed', default=COUNTERS_SEED, show_default=True, type=click.IntRange(0, 2**31),
              help='Of plant, noise and biases.')  # fmt: skip
@FORCE_OPTION
def counters(table: Path, out: Path, seed: int, force: bool) -> None:
    """Diagnose a simulated trial whose winch counters err as measured ones did.

    With tows of a baseline and without. Writes counters.json, .md, .html and .png.
    """
    known = read_table(table)
    made_folder(empty_folder(out, force=force))
    with stoppable() as (display, _):
        rows = run_counters(known, out, display, seed)
    print_outcome(rows, out / COUNTERS_REPORT)


@command.command('flume')
@click.option('--table', required=True, type=FILE, help='CSV of states of a net in a flume tank.')
@REPORT_OPTION
@FORCE_OPTION
def flume(table: Path, out: Path, force: bool) -> None:
    """Set a net that is held in a flume tank beside the model.

    Writes flume.json, .md, .html and .png.
    """
    states = read_states(table)
    made_folder(empty_folder(out, force=force))
    with stoppable() as (display, _):
        rows = run_flume(states, out, display)
    print_outcome(rows, out / FLUME_REPORT)


@command.command('hostile')
@REPORT_OPTION
@FORCE_OPTION
@click.option('--messages', default=100_000, show_default=True,
              type=click.IntRange(100, 100_000_000), help='Hostile messages.')  # fmt: skip
@click.option('--seed', default=1, show_default=True, type=click.IntRange(0, 2**31),
              help='Of all draws.')  # fmt: skip
def hostile(out: Path, force: bool, messages: int, seed: int) -> None:
    """Send messages that make no sense to each subscription of each node.

    Nodes run in this process and get the bytes as from the middleware. Writes
    hostile_messages.json.
    """
    try:
        from trawl_ros.lab.studies.hostile.report import REPORT as HOSTILE_REPORT
        from trawl_ros.lab.studies.hostile.report import write_hostile
        from trawl_ros.lab.studies.hostile.study import run_hostile
    except ImportError as reason:
        raise RosMissing('the study of hostile messages', reason) from reason
    empty_folder(out, force=force)
    with ProgressDisplay(error_console()) as display:
        found = run_hostile(messages, seed, display)
    print_outcome(write_hostile(out, found, seed), out / HOSTILE_REPORT)


@command.command('discrepancy')
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
def discrepancy(
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


@command.command('robustness')
@click.option('--out', required=True, type=FOLDER, help='Folder of the report and of the trials.')
@GEAR_OPTION
@click.option('--around', default=RobustnessPlan.around, show_default=True,
              type=click.IntRange(12, 96), help='Meshes around the net.')  # fmt: skip
@click.option('--hours', default=RobustnessPlan.hours, show_default=True,
              type=click.IntRange(0, 100_000), help='Hours of random commands.')  # fmt: skip
@click.option('--length-m', 'lengths', multiple=True, type=click.FloatRange(100.0, 2000.0),
              default=LENGTHS, show_default=True,
              help='Warp of the changed gears; repeatable.')  # fmt: skip
@click.option('--values/--no-values', default=True, help='Tow the changed gears too.')
@click.option('--shard', nargs=2, default=(1, 1), show_default=True, type=click.IntRange(1, 1000),
              help='Part of the trials to make here, and of how many.')  # fmt: skip
@click.option('--minutes', default=60.0, show_default=True, type=click.FloatRange(0.0, 6000.0),
              help='Wall time after which no trial is begun.')  # fmt: skip
def robustness(
    out: Path,
    gear: str,
    around: int,
    hours: int,
    lengths: tuple[float, ...],
    values: bool,
    shard: tuple[int, int],
    minutes: float,
) -> None:
    """Change each number of a gear file by a fifth, and tow hours of random commands.

    Writes robustness.json, .md and .html. Trials that are in the folder already are not made
    again; shards may run side by side into one folder.
    """
    empty_folder(out, force=True)
    lengths = lengths if values else ()
    plan = RobustnessPlan(gear, around, hours, lengths, *shard, 60.0 * minutes)
    with stoppable(f'the trials made so far are kept in {out}') as (display, _):
        trials = run_robustness(plan, out, display)
    print_outcome(write_robustness(out, trials), out / ROBUSTNESS_REPORT)


@command.command('onset')
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
@click.option('--limit', 'draws', default=0, type=click.IntRange(0, 5000),
              help='Instead: draw the innovations of one clean tow so often, and print the limit '
              'that they exceed once in 230 h.')  # fmt: skip
def onset(
    out: Path,
    gear: str,
    trials: int,
    clean: int,
    minutes: float,
    seed: int,
    shard: tuple[int, int],
    draws: int,
) -> None:
    """Let effects begin during tows, and count how soon they are found, and what is found without.

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
    plan = OnsetPlan(gear, trials, clean, minutes, seed, *shard)
    with stoppable(f'the trials made so far are kept in {out}') as (display, _):
        made = run_onset(plan, out, display)
    print_outcome(write_onset(out, plan, made), out / ONSET_REPORT)


@command.command('sailing')
@REPORT_OPTION
@FORCE_OPTION
@GEAR_OPTION
@click.option('--around', default=SailingPlan.around, show_default=True,
              type=click.IntRange(12, 96), help='Meshes around the net.')  # fmt: skip
@click.option('--hours', default=SailingPlan.hours, show_default=True,
              type=click.FloatRange(0.5, 48.0), help='Time at sea of each course.')  # fmt: skip
@click.option('--boards', default=SailingPlan.boards, show_default=True,
              type=click.IntRange(1, 1000), help='Random boards.')  # fmt: skip
@click.option('--seed', default=SailingPlan.seed, show_default=True, type=click.IntRange(0))
def sailing(
    out: Path, force: bool, gear: str, around: int, hours: float, boards: int, seed: int
) -> None:
    """Sail trials that run themselves, beside a planned trial and the paper's sweep.

    Writes sailing.json, .md and .html.
    """
    empty_folder(out, force=force)
    plan = SailingPlan(gear, around, hours, boards, seed)
    with stoppable() as (display, _):
        towed = run_sailing(plan, display)
    print_outcome(write_sailing(out, plan, towed), out / SAILING_REPORT)


@contextmanager
def _until_stopped() -> Iterator[Callable[[], bool]]:
    """Let Ctrl-C end a tow early, and the command once its report is written."""
    with Interruption() as interruption:
        yield lambda: interruption.requested
    if interruption.requested:
        raise SystemExit(INTERRUPTED)
