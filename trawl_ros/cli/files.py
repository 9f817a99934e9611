"""Kinds of arguments that are files of the user's."""

from pathlib import Path

import click

SCENARIO = click.Path(path_type=Path)
BAG = click.Path(path_type=Path)
FOLDER = click.Path(path_type=Path, file_okay=False)
