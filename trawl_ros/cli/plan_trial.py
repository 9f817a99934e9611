# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``trawl plan-trial``."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from trawl_ros.cli.console.progress import ProgressDisplay, error_console
from trawl_ros.cli.console.tables import output_console, plain_table
from trawl_ros.cli.options import FOLDER, FORCE_OPTION, Number

if TYPE_CHECKING:
    from trawl_ros.estimation.planning.plan import TrialPlan

MAX_VALUES_OF_A_LIST = 20
"""Each pair of length and speed takes seconds to solve."""


class _Numbers(click.ParamType[tuple[float, ...]]):
    """Sorted distinct numbers between two limits, separated by commas."""

    name = 'numbers'

    def __init__(self, low: float, high: float) -> None:
        self._one = Number(low, high)

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[float, ...]:
        """Read the list."""
        if isinstance(value, tuple):
            return value
        numbers = {float(self._one.convert(text.strip(), param, ctx)) for text in value.split(',')}
        if len(numbers) > MAX_VALUES_OF_A_LIST:
            told = f'found {len(numbers)} numbers, expected at most {MAX_VALUES_OF_A_LIST}'
            self.fail(told, param, ctx)
        return tuple(sorted(numbers))


@click.command('plan-trial')
@click.argument('gear', metavar='GEAR')
@click.option(
    '--hours',
    default=6.0,
    show_default=True,
    type=Number(0.0, 48.0, min_open=True),
    help='Time at sea, h.',
)
@click.option('--out', type=FOLDER, help='Folder for plan.json, trial.yaml and plan.png.')
@click.option(
    '--lengths-m',
    type=_Numbers(20.0, 3000.0),
    metavar='L,L,…',
    help='Warp lengths to choose from, m.  [default: as in the paper, 200 to 900]',
)
@click.option(
    '--speeds-m-s',
    type=_Numbers(0.5, 4.0),
    metavar='U,U,…',
    help='Speeds to choose from, m/s.  [default: 1.9 to 2.5]',
)
@click.option(
    '--max-tension-kn',
    type=Number(0.0, 2000.0, min_open=True),
    help='Largest allowed tension of a warp, kN.',
)
@click.option(
    '--seabed-m',
    type=Number(10.0, 11_000.0),
    help='Depth of the water, m; the gear stays 10 m above the seabed.',
)
@FORCE_OPTION
def command(
    gear: str,
    hours: float,
    out: Path | None,
    lengths_m: tuple[float, ...] | None,
    speeds_m_s: tuple[float, ...] | None,
    max_tension_kn: float | None,
    seabed_m: float | None,
    force: bool,
) -> None:
    """Plan a sea trial that determines the boards of GEAR best in a given time.

    GEAR is a gear file or the name of a gear of the package. The command prints the expected
    accuracy, compared with the paper's sweep of warp lengths at one speed. With --out it writes the
    plan, a scenario for ``trawl tow``, and a picture.
    """
    from trawl_ros.api import trials
    from trawl_ros.estimation.planning.states import Limits

    limits = Limits(
        lengths=lengths_m or Limits.lengths,
        speeds=speeds_m_s or Limits.speeds,
        max_tension=None if max_tension_kn is None else 1e3 * max_tension_kn,
        seabed=seabed_m,
    )
    with ProgressDisplay(error_console()) as display:
        plan = trials.plan_trial(
            gear, hours=hours, limits=limits, out=out, force=force, on_progress=display
        )
    print_plan(plan)
    if out is not None:
        click.echo(f'\nWritten to {out}. To tow it: trawl tow {out}/trial.yaml --out BAG')


def print_plan(plan: 'TrialPlan') -> None:
    """Print the legs, the accuracy after them, and what limits the rest."""
    from trawl_ros.estimation.fit.laws import LAWS, QUANTITIES

    console = output_console()
    legs = plain_table(
        'leg', 'warps / m', 'speed / (m/s)', 'minutes', 'well known', 'helps most', 'sd / span',
        right=('leg', 'warps / m', 'speed / (m/s)', 'minutes', 'well known'),
    )  # fmt: skip
    for number, (leg, gain) in enumerate(zip(plan.trial.legs, plan.gains, strict=True), 1):
        lengths, _, _ = str(leg.manoeuvre).partition(' ')
        legs.add_row(
            str(number), lengths, f'{leg.manoeuvre.speed:g}', f'{leg.total_minutes:.1f}',
            f'{gain.well_known} of {len(QUANTITIES)}', gain.quantity,
            f'{100 * gain.before:.1f} → {100 * gain.after:.1f} %',
        )  # fmt: skip
    console.print(legs)
    console.print(f'{plan.trial.minutes / 60.0:.2f} h in all.\n')

    trials = (plan.trial, *plan.sweeps)
    known = plain_table(
        'law', 'quantity', 'before', *(trial.name for trial in trials), 'limited by',
        right=('before', *(trial.name for trial in trials)),
    )  # fmt: skip
    for index, name in enumerate(QUANTITIES):
        law = LAWS[index % len(LAWS)]
        known.add_row(
            law.name, name, f'{100 * plan.before.ratio[index]:.0f} %',
            *(f'{100 * trial.known.ratio[index]:.1f} %' for trial in trials),
            plan.limits.get(name, ''),
        )  # fmt: skip
    for title, kind in (
        ('well known (below 20 %)', 'known'),
        ('… from the data only', 'by_data'),
        ('… if the board is that of the gear file', 'as_filed'),
    ):
        numbers = [getattr(trial, kind).well_known.sum() for trial in trials]
        known.add_row(title, '', '', *(f'{number} of {len(QUANTITIES)}' for number in numbers))
    console.print(known)
    sweep = plan.sweeps[0]
    if sweep.legs:
        console.print(
            f'\nStandard deviations are relative to the span of each law over 15°. The sweep takes '
            f'{len(sweep.legs)} states at {sweep.legs[0].manoeuvre.speed:g} m/s in '
            f'{sweep.minutes / 60.0:.2f} h.',
            soft_wrap=True,
        )
    reasons = ', '.join(sorted({refused.reason for refused in plan.choice.refused}))
    if reasons:
        console.print(
            f'{len(plan.choice.refused)} of '
            f'{len(plan.choice.refused) + len(plan.choice.candidates)} manoeuvres are not '
            f'possible: {reasons}.',
            soft_wrap=True,
        )
