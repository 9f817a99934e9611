"""``trawl policy``."""

import re

import click

from trawl_ros.records.policy import policy
from trawl_ros.records.topics import NAMESPACE

NAME = re.compile(r'[A-Za-z_]\w*(/[A-Za-z_]\w*)*', re.ASCII)


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
def command(namespace: str) -> None:
    """Print which topics and services each node may use, as a policy of SROS 2.

    Each node has an enclave named as it is, /trawl/winch_node for instance, with the rights that it
    uses and no more. Only controllers and the enclaves `operator` and `set_points` may command.
    """
    click.echo(policy(namespace), nl=False)
