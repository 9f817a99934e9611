# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``trawl policy``."""

import re
from pathlib import Path

import click

from trawl_ros.cli.options import FOLDER
from trawl_ros.core.errors import TrawlError
from trawl_ros.core.files import made_folder, new_folder
from trawl_ros.records.permissions import security_files
from trawl_ros.records.topics import NAMESPACE

NAMESPACE_PATTERN = re.compile(r'[A-Za-z_]\w*(/[A-Za-z_]\w*)*', re.ASCII)
MAX_DOMAIN_ID = 232
"""Highest ``ROS_DOMAIN_ID`` with valid ports."""


def _namespace(ctx: click.Context, param: click.Parameter, value: str) -> str:
    if not NAMESPACE_PATTERN.fullmatch(value.strip('/')):
        raise click.BadParameter(
            f'found {value!r}, expected a namespace of ROS such as {NAMESPACE}'
        )
    return value.strip('/')


@click.command('policy')
@click.option(
    '--namespace',
    default=NAMESPACE,
    show_default=True,
    callback=_namespace,
    help='Namespace of the nodes.',
)
@click.option(
    '--domain', default=0, show_default=True, type=click.IntRange(0, MAX_DOMAIN_ID),
    help='ROS_DOMAIN_ID of the graph, written to governance and permissions.',
)  # fmt: skip
@click.option(
    '--out', type=FOLDER, help='New folder for policy, governance and the permissions of each node.'
)
def command(namespace: str, domain: int, out: Path | None) -> None:
    """Print the topics and services that each node may use, as an SROS 2 policy.

    Each node has an enclave of the same name, such as /trawl/winch_node, with only the rights that
    it needs. Only controllers and the enclaves `operator` and `set_points` may send commands.
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
