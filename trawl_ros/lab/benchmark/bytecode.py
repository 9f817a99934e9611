"""Bytecode of child processes: kept, as it is unless Python is told otherwise."""

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager

NO_BYTECODE = 'PYTHONDONTWRITEBYTECODE'
"""Variable with which each process compiles anew whatever it imports, as no user's does."""


@contextmanager
def bytecode_kept(*modules: str) -> Iterator[None]:
    """Let child processes keep and use bytecode; that of some modules is there from the start."""
    before = os.environ.pop(NO_BYTECODE, None)
    try:
        if modules:
            code = f'import {", ".join(modules)}'
            subprocess.run([sys.executable, '-c', code], check=True, capture_output=True)
        yield
    finally:
        if before is not None:
            os.environ[NO_BYTECODE] = before
