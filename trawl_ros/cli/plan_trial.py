# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``trawl plan-trial``."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from trawl_ros.cli.console.progress import ProgressDisplay, error_console
from trawl_ros.cli.console.tables import output_console, plain_table
from trawl_ros.cli.options import FOLDER, FORCE_OPTION, UNITS_OPTION, Number, QuantityNumber
from trawl_ros.core.display_units import METRIC, DisplayUnits

if TYPE_CHECKING:
    from trawl_ros.estimation.planning.plan import TrialPlan

MAX_VALUES_OF_A_LIST = 20
"""Each pair of length and speed takes seconds to solve."""


class _Quantities(click.ParamType[tuple[float, ...]]):
    """Sorted distinct quantities between two limits (SI), separated by commas."""

    name = 'quantities'

    def __init__(self, quantity: str, low: float, high: float) -> None:
        self._one = QuantityNumber(quantity, low, high)

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
    '--warps',
    type=_Quantities('warp', 20.0, 3000.0),
    metavar='L,L,…',
    help='Warp lengths to choose from, m.  [default: as in the paper, 200 to 900]',
)
@click.option(
    '--speeds',
    type=_Quantities('speed', 0.5, 4.0),
    metavar='U,U,…',
    help='Speeds to choose from, m/s.  [default: 1.9 to 2.5]',
)
@click.option(
    '--max-tension',
    type=QuantityNumber('tension', 100.0, 2e6),
    help='Largest allowed tension of a warp, kN.',
)
@click.option(
    '--seabed',
    type=QuantityNumber('depth', 10.0, 11_000.0),
    help='Depth of the water, m; the gear stays 10 m above the seabed.',
)
@UNITS_OPTION
@FORCE_OPTION
def command(
    gear: str,
    hours: float,
    out: Path | None,
    warps: tuple[float, ...] | None,
    speeds: tuple[float, ...] | None,
    max_tension: float | None,
    seabed: float | None,
    units: DisplayUnits,
    force: bool,
) -> None:
    """Plan a sea trial that determines the boards of GEAR best in a given time.

    GEAR is a gear file or the name of a gear of the package. The command prints the expected
    accuracy, compared with the paper's sweep of warp lengths at one speed, and what a fit of the
    whole tow will know. With --out it writes the plan, a scenario for `trawl tow`, and a picture.
    """
    from trawl_ros.api import trials
    from trawl_ros.estimation.planning.states import Limits

    limits = Limits(
        lengths=warps or Limits.lengths,
        speeds=speeds or Limits.speeds,
        max_tension=max_tension,
        seabed=seabed,
    )
    with ProgressDisplay(error_console()) as display:
        plan = trials.plan_trial(
            gear, hours=hours, limits=limits, out=out, force=force, on_progress=display
        )
    print_plan(plan, units)
    if out is not None:
        click.echo(f'\nWritten to {out}. To tow it: trawl tow {out}/trial.yaml --out BAG')


def print_plan(plan: 'TrialPlan', units: DisplayUnits = METRIC) -> None:
    """Print the legs, the accuracy after them, and what limits the rest."""
    from trawl_ros.estimation.fit.laws import LAWS, QUANTITIES

    console = output_console()
    warps, speed = f'warps, {units.symbol("warp")}', f'speed, {units.symbol("speed")}'
    legs = plain_table(
        'leg', warps, speed, 'minutes', 'well known', 'helps most', 'sd / span',
        right=('leg', warps, speed, 'minutes', 'well known'),
    )  # fmt: skip
    for number, (leg, gain) in enumerate(zip(plan.trial.legs, plan.gains, strict=True), 1):
        sides = (leg.manoeuvre.port_length, leg.manoeuvre.starboard_length)
        lengths = '/'.join(dict.fromkeys(units.number(side, 'warp', 0) for side in sides))
        legs.add_row(
            str(number), lengths, units.number(leg.manoeuvre.speed, 'speed'),
            f'{leg.total_minutes:.1f}',
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
    console.print(f'\nThe table counts steady windows only. {_in_motion(plan)}', soft_wrap=True)
    sweep = plan.sweeps[0]
    if sweep.legs:
        console.print(
            f'\nStandard deviations are relative to the span of each law over 15°. The sweep takes '
            f'{len(sweep.legs)} states at {units.shown(sweep.legs[0].manoeuvre.speed, "speed")} in '
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


def _in_motion(plan: 'TrialPlan') -> str:
    """Return what a fit of the whole tow will know, or why that is not known."""
    known = plan.in_motion
    if known is None:
        return f'The model was not towed along the plan: {plan.windows_only}.'
    steady, whole = known.steady.well_known, known.whole.well_known
    told = (
        f'By the steady parts of the tow {steady.sum()} of {len(steady)} are well known; with '
        f'hauling, veering and changes of speed {whole.sum()} of {len(whole)}, and standard '
        f'deviations are {known.ratio:.2f} times as large.'
    )
    if known.left_out:
        told += f' {known.left_out_minutes:.1f} min do not count: {known.left_out[0].why}.'
    return told
