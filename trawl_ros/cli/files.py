"""Argument types of the user's files."""

from pathlib import Path

import click

SCENARIO = click.Path(path_type=Path)
BAG = click.Path(path_type=Path)
FILE = click.Path(path_type=Path, dir_okay=False)
FOLDER = click.Path(path_type=Path, file_okay=False)
