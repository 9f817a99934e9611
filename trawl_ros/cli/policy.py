"""``trawl policy``."""

import re
from pathlib import Path

import click

from trawl_ros.cli.options import FOLDER
from trawl_ros.core.errors import TrawlError
from trawl_ros.core.files import made_folder, new_folder
from trawl_ros.records.permissions import security_files
from trawl_ros.records.topics import NAMESPACE

NAME = re.compile(r'[A-Za-z_]\w*(/[A-Za-z_]\w*)*', re.ASCII)
MOST_DOMAIN = 232
"""Highest ``ROS_DOMAIN_ID`` that has ports."""


def _namespace(ctx: click.Context, param: click.Parameter, value: str) -> str:
    if not NAME.fullmatch(value.strip('/')):
        raise click.BadParameter(
            f'found {value!r}, expected a namespace of ROS such as {NAMESPACE}'
        )
    return value.strip('/')


@click.command('policy')
@click.option(
    '--namespace', default=NAMESPACE, show_default=True, callback=_namespace, help='Of the nodes.'
)
@click.option(
    '--domain', default=0, show_default=True, type=click.IntRange(0, MOST_DOMAIN),
    help='ROS_DOMAIN_ID of the graph, which governance and permissions name.',
)  # fmt: skip
@click.option(
    '--out', type=FOLDER, help='New folder for policy, governance and the permissions of each node.'
)
def command(namespace: str, domain: int, out: Path | None) -> None:
    """Print which topics and services each node may use, as a policy of SROS 2.

    Each node has an enclave named as it is, /trawl/winch_node for instance, with the rights that it
    uses and no more. Only controllers and the enclaves `operator` and `set_points` may command.
    """
    files = security_files(namespace, domain)
    if out is None:
        click.echo(files['policy.xml'], nl=False)
        return
    new_folder(out, TrawlError)
    for name, text in files.items():
        path = out / name
        made_folder(path.parent)
        path.write_text(text)
