# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Types of arguments, and options that several commands share."""

import math
from pathlib import Path
from typing import Any

import click

from trawl_ros.cli.console.loaded_group import UNITS_KEY
from trawl_ros.core.display_units import METRIC, DisplayUnits, parse_units, parse_value
from trawl_ros.core.errors import TrawlError
from trawl_ros.core.resources import packaged_bag
from trawl_ros.records.topics import NAMESPACE
from trawl_ros.records.towing_limits import LIMITS


class RecordedBag(click.Path):
    """Bag that exists: a path, or the name of a sample bag of the package."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Path:
        """Return the path."""
        return packaged_bag(Path(str(super().convert(value, param, ctx))))


SCENARIO = click.Path(path_type=Path)
BAG = RecordedBag(path_type=Path)
NEW_BAG = click.Path(path_type=Path)
FILE = click.Path(path_type=Path, dir_okay=False)
FOLDER = click.Path(path_type=Path, file_okay=False)


class Number(click.FloatRange):
    """Number in a range; NaN is refused, which comparisons do not exclude."""

    name = 'number'
    unit, unit_size = '', 1.0

    def _describe_range(self) -> str:
        """Describe the range in help and errors, with its unit."""
        bounds = (bound for bound in (self.min, self.max) if bound is not None)
        numbers = ' to '.join(f'{bound / self.unit_size:.10g}' for bound in bounds)
        return f'{numbers} {self.unit}'.rstrip()

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> float:
        """Return the number."""
        number = float(super().convert(value, param, ctx))
        if math.isnan(number):
            self.fail('nan is not a number, expected one', param, ctx)
        return number


class UnitsType(click.ParamType[DisplayUnits]):
    """Choice of units; numbers of the same command without a unit are read in them."""

    name = 'units'

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> DisplayUnits:
        """Read the choice, and keep it for the other parameters."""
        try:
            units = value if isinstance(value, DisplayUnits) else parse_units(value)
        except TrawlError as error:
            self.fail(str(error), param, ctx)
        if ctx is not None:
            ctx.meta[UNITS_KEY] = units
        return units


class QuantityNumber(Number):
    """Number in a range of SI units, read with a unit such as ``250fm`` or in those of --units.

    Defaults are in SI units.
    """

    name = 'quantity'

    def __init__(self, quantity: str, low: float, high: float) -> None:
        super().__init__(low, high)
        self._quantity = quantity
        self.unit, self.unit_size = METRIC.symbol(quantity), METRIC.size(quantity)

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> float:
        """Return the number in SI units."""
        units = METRIC if ctx is None else ctx.meta.get(UNITS_KEY, METRIC)
        if isinstance(value, str):
            try:
                value = parse_value(value, self._quantity, units)
            except TrawlError as error:
                self.fail(str(error), param, ctx)
        return super().convert(value, param, ctx)


WARP = QuantityNumber('warp', *LIMITS.warp_m)
SPEED = QuantityNumber('speed', *LIMITS.speed_m_s)

UNITS_OPTION = click.option(
    '--units', type=UnitsType(), default='metric', show_default=True, is_eager=True,
    metavar='SYSTEM', help='Units, printed and read: metric (m, m/s, kN), sea (m, knots, tonnes), '
    'imperial (fathoms, feet, knots, pounds), or pairs such as speed=kn,warp=fm. A number may '
    'carry its own unit: 250fm, 4kn.',
)  # fmt: skip

GEAR_OPTION = click.option(
    '--gear', default='kaifuha', show_default=True, help='Gear file of the model, or name of a '
    'gear of the package.',
)  # fmt: skip
NAMESPACE_OPTION = click.option(
    '--namespace',
    default=NAMESPACE,
    show_default=True,
    help='Namespace of the topics that are read.',
)
SCHEDULER_OPTION = click.option(
    '--scheduler', help='Address of a Dask cluster for the work. It must see all files under the '
    'same paths, and it runs code, so it must be trusted; tls:// uses the keys of Dask. '
    'By default, processes of this machine do the work.',
)  # fmt: skip
FORCE_OPTION = click.option(
    '--force', is_flag=True, help='Replace the results of an earlier run in --out.'
)
REPORT_OPTION = click.option('--out', required=True, type=FOLDER, help='Folder of the report.')
