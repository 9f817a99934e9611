"""Types of arguments, and options that several commands share."""

import math
from pathlib import Path
from typing import Any

import click

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

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> float:
        """Return the number."""
        number = float(super().convert(value, param, ctx))
        if math.isnan(number):
            self.fail('nan is not a number, expected one', param, ctx)
        return number


WARP = Number(*LIMITS.warp_m)
SPEED = Number(*LIMITS.speed_m_s)

GEAR_OPTION = click.option(
    '--gear', default='kaifuha', show_default=True, help='Gear file of the model, or name of a '
    'gear of the package.',
)  # fmt: skip
NAMESPACE_OPTION = click.option(
    '--namespace', default=NAMESPACE, show_default=True, help="Namespace of the project's topics."
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
