"""Last act of the demo: tows in a current that the model lacks, diagnosed, named, and repaired.

All of it goes through the commands and nodes that a user has, each a process of its own.
"""

import subprocess
import sys
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import click
from rich.console import Console

from trawl_ros.core.errors import TrawlError
from trawl_ros.core.files import made_folder
from trawl_ros.core.parallel import cores
from trawl_ros.diagnosis.report.writing import MODEL
from trawl_ros.lab.demo.repaired import tow_repaired

BASELINE = 'baseline'
TOWS = ('tow_1', 'tow_2', 'tow_3')
"""Bags, each of the scenario of its name with ``hidden_`` before it."""

FOUND = 'diagnosis'
REPAIRED = 'repaired'
AGAIN = 'diagnosis_of_repaired'

NO_DISCREPANCY, DISCREPANCY = 0, 10
"""Exit codes of ``trawl diagnose``."""


class Commands:
    """Runner of ``trawl`` commands in a folder; leaving the context ends those that still run.

    Parameters
    ----------
    folder
        Working folder, to which their arguments are relative.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._running: list[subprocess.Popen[str]] = []

    def run(self, *words: str, expected: int = 0) -> str:
        """Run a command to its end, and give what it printed.

        Raises
        ------
        TrawlError
            With what the command said, if it ends with another code than expected.
        """
        process = subprocess.Popen(
            [sys.executable, '-c', 'from trawl_ros.cli.main import main; main()', *words],
            cwd=self._folder,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        self._running.append(process)
        out, errors = process.communicate()
        if process.returncode != expected:
            raise TrawlError(
                f'{self._folder}: trawl {" ".join(words)} ended with {process.returncode}, '
                f'expected {expected}: {(errors or out).strip()}'
            )
        return out

    def __enter__(self) -> 'Commands':
        return self

    def __exit__(self, *_: object) -> None:
        for process in self._running:
            if process.poll() is None:
                process.terminate()


def hidden_effect(folder: Path, console: Console) -> None:
    """Tow in water that the model does not know, diagnose the bags, and again with the repair.

    Writes bags and reports into ``folder``, one of the repaired gear towed by `sim_node` among
    them, and prints the commands and what they find.

    Raises
    ------
    TrawlError
        If a command fails, the current is not found, or the repaired gear leaves something over.
    """
    made_folder(folder)
    bags = (BASELINE, *TOWS)
    diagnose = ('diagnose', *TOWS, '--baseline', BASELINE, '--out')
    with ThreadPoolExecutor(cores()) as pool, Commands(folder) as commands:
        towing = [_shown('tow', f'hidden_{bag}', '--out', bag) for bag in bags]
        with console.status('towing in a current that the model does not know'):
            try:
                list(pool.map(lambda words: commands.run(*words), towing))
            except BaseException:
                pool.shutdown(wait=False, cancel_futures=True)
                raise
        with console.status('diagnosing'):
            found = commands.run(*_shown(*diagnose, FOUND), expected=DISCREPANCY)
        click.echo(found)
        model = folder / FOUND / MODEL
        if not model.is_file():
            raise TrawlError(f'{model.parent}: no effect has a name there, expected the current')
        tow_repaired(f'hidden_{TOWS[0]}', model, folder / TOWS[0], folder / REPAIRED, console)
        repaired = ('--gear', f'{FOUND}/{MODEL}')
        with console.status('diagnosing with the repaired gear'):
            again = commands.run(*_shown(*diagnose, AGAIN, *repaired), expected=NO_DISCREPANCY)
        click.echo(again)


def _shown(*words: str) -> Sequence[str]:
    click.echo(f'$ trawl {" ".join(words)}')
    return words
