"""One target: a reader of the project, and a strategy for what it may be given."""

from collections.abc import Callable, Mapping
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass, field
from io import StringIO
from pathlib import Path

from hypothesis.strategies import SearchStrategy

Files = Mapping[str, bytes]
"""An input: content by name relative to a folder (``'bag/metadata.yaml'``)."""

Reader = Callable[[Path, Path], object]
"""Called with the folder of the input and one for results, which does not exist yet.

It may raise `TrawlError`, which is the sentence wanted; anything else that it raises is a fault.
"""


@dataclass(frozen=True)
class Target:
    """A reader and what it is given.

    Attributes
    ----------
    name
        By which it is chosen, and by which its corpus is found (``corpus/<name>/``).
    inputs
        Strategy for hostile inputs.
    read
        The reader.
    examples
        How many inputs `make test-slow` gives it, and `make test` a quarter of them. All targets
        together take a minute at most.
    known
        Inputs that once broke it and are better made than kept, by what they are.
    """

    name: str
    inputs: SearchStrategy[Files]
    read: Reader
    examples: int = 100
    known: Mapping[str, Callable[[], Files]] = field(default_factory=dict)


def one_file(name: str, content: SearchStrategy[bytes]) -> SearchStrategy[Files]:
    """Inputs of a single file."""
    return content.map(lambda content: {name: content})


def command(*args: object) -> str:
    """Run ``trawl`` in this process as a shell would; what it says.

    Raises
    ------
    AssertionError
        If it shows a traceback, or fails without a sentence.
    Exception
        What went through the command.
    """
    from trawl_ros.cli.bag import EXIT_FINDINGS
    from trawl_ros.cli.main import trawl

    said, code = StringIO(), 0
    with redirect_stdout(said), redirect_stderr(said):
        try:
            trawl.main([str(arg) for arg in args], prog_name='trawl')
        except SystemExit as end:
            code = end.code if isinstance(end.code, int) else 1
    text = said.getvalue()
    assert 'Traceback (most recent call last)' not in text, text[-2000:]
    assert code in (0, EXIT_FINDINGS) or 'Error: ' in text, (
        f'exit {code} without a sentence: {text[-200:]!r}'
    )
    return text
