# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Group of commands that are imported when they are called."""

from collections.abc import Mapping
from importlib import import_module
from typing import Any

import click

from trawl_ros.core.resources import nearest

UNITS_KEY = 'trawl_ros.units'
"""Key of the chosen units among what click keeps of a command."""


class LoadedGroup(click.Group):
    """Group of commands, each loaded when it is called.

    Parameters
    ----------
    modules
        For each name, the module of `trawl_ros` with its ``command`` and the sentence in the list
        of commands, in the order of the list. The list is printed without importing the modules.
    options
        Options of `click.Group`.
    """

    def __init__(self, modules: Mapping[str, tuple[str, str]], **options: Any) -> None:
        super().__init__(**options)
        self.modules = modules

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Return the names in their order."""
        return list(self.modules)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Load one command."""
        if cmd_name not in self.modules:
            return None
        module, _ = self.modules[cmd_name]
        command = import_module(f'trawl_ros.{module}').command
        assert isinstance(command, click.Command)
        return command

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Find the command; an unknown one is refused with the nearest name, or with all."""
        name = args[0]
        if name not in self.modules and name[:1].isalnum() and not ctx.resilient_parsing:
            known = nearest(name, self.modules) or f'; there are: {", ".join(self.modules)}'
            ctx.fail(f'{name}: no such command{known}')
        return super().resolve_command(ctx, args)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """List the commands without loading them."""
        with formatter.section('Commands'):
            formatter.write_dl([(name, said) for name, (_, said) in self.modules.items()])
