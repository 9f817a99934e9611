"""Types of arguments, and options that several commands have."""

from pathlib import Path

import click

from trawl_ros.records.topics import NAMESPACE

SCENARIO = click.Path(path_type=Path)
BAG = click.Path(path_type=Path)
FILE = click.Path(path_type=Path, dir_okay=False)
FOLDER = click.Path(path_type=Path, file_okay=False)
WARP = click.FloatRange(20.0, 3000.0)
SPEED = click.FloatRange(0.5, 4.0)

GEAR_OPTION = click.option(
    '--gear', default='kaifuha', show_default=True, help='The gear as the model has it: a file or '
    'the name of one that comes with the package.',
)  # fmt: skip
NAMESPACE_OPTION = click.option(
    '--namespace', default=NAMESPACE, show_default=True, help="Where the project's topics live."
)
SCHEDULER_OPTION = click.option(
    '--scheduler', help='Address of a Dask cluster that shares the work, which must see all files '
    'under the same paths; without it, processes of this machine do. It runs code and must be '
    "trusted; tls:// takes the keys of Dask's configuration.",
)  # fmt: skip
FORCE_OPTION = click.option(
    '--force', is_flag=True, help='Replace the results of an earlier run in --out.'
)
REPORT_OPTION = click.option('--out', required=True, type=FOLDER, help='Folder of the report.')
