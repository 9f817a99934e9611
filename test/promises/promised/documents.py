"""Collection of all commands and code blocks of README and docs."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from markdown_it import MarkdownIt
from markdown_it.token import Token

ROOT = Path(__file__).parents[3]
TABLE = ROOT / 'docs/promises.md'
MAKES = r'(?:--out |--target |>> ?|> |output:=|missing-effect make )(\S+)'
"""What stands before the name of a file or folder that a command makes."""


@dataclass(frozen=True)
class Promise:
    """One command, or one block of Python, as it stands in a document."""

    document: str
    heading: str
    line: int
    language: str
    text: str
    printed: tuple[str, ...] | None
    """Lines that it prints, with … for some that are left out; None where none are shown."""

    @property
    def place(self) -> str:
        return f'{self.document}:{self.line}'

    @property
    def title(self) -> str:
        """The command without its comment; the first line of a block of Python."""
        if self.language == 'python':
            return f'{self.text.splitlines()[0]} …'
        return ' '.join(re.sub(r'\s#\s.*|\\\n', ' ', self.text).split())

    @property
    def node(self) -> str | None:
        """The node that it starts and that runs until it is ended."""
        found = re.match(r'ros2 run trawl_ros (\w+)', self.text)
        return found and found[1]

    @property
    def makes(self) -> set[str]:
        """Files and folders that it leaves, by their names in the command."""
        copies = re.findall(r'^(?:cp (?:-r )?|trawl gear copy )\S+ (\S+)$', self.title)
        return set(re.findall(MAKES, self.title)) | set(copies)

    @property
    def names(self) -> set[str]:
        """All names of files in it, and of the folders that they are in."""
        return names_in(self.text)


@dataclass(frozen=True)
class Document:
    """What a document has: things to run, files to copy, commands in the midst of sentences."""

    name: str
    promises: tuple[Promise, ...]
    files: dict[str, str]
    mentioned: tuple[str, ...]
    unknown: tuple[str, ...]

    def before(self, promise: Promise) -> list[Promise]:
        """All that has to be run before a command, since it makes what that command names."""
        direct = [
            other
            for other in self.promises
            if other != promise and other.makes & (self._needs(promise) - promise.makes)
        ]
        return list(
            dict.fromkeys(step for other in direct for step in (*self.before(other), other))
        )

    def _needs(self, promise: Promise) -> set[str]:
        """Names in a command, and in the files of this document that it names."""
        texts = (text for file, text in self.files.items() if file in promise.names)
        return promise.names.union(*map(names_in, texts))


@cache
def names_in(text: str) -> set[str]:
    """Words that may be names of files, and the folders that these are in."""
    words = re.split(r'[\s\'"=,()\[\]]+', text)
    return {str(part) for word in words for part in (Path(word), *Path(word).parents)}


def logical_lines(text: str) -> Iterator[tuple[int, str]]:
    """Number and text of the commands of a shell block, continued lines as one."""
    for found in re.finditer(r'(?:.*\\\n)*.+', text):
        if not found[0].startswith('#'):
            yield text.count('\n', 0, found.start()), found[0]


def read_block(token: Token, name: str, heading: str) -> Iterator[Promise]:
    """Give the commands of a block of code."""
    assert token.map is not None
    first = token.map[0] + 2
    if token.info == 'python':
        yield Promise(name, heading, first, 'python', token.content, None)
    elif token.info == 'console':
        for found in re.finditer(r'^\$ (.+)\n((?:(?!\$ ).*\n)*)', token.content, re.M):
            line = first + token.content.count('\n', 0, found.start())
            printed = tuple(found[2].splitlines())
            yield Promise(name, heading, line, 'shell', found[1], printed)
    else:
        for line, command in logical_lines(token.content):
            yield Promise(name, heading, first + line, 'shell', command, None)


def read_document(path: Path) -> Document:
    """Read all blocks and commands of a document."""
    name = path.relative_to(ROOT).as_posix()
    promises: list[Promise] = []
    files: dict[str, str] = {}
    mentioned: list[str] = []
    unknown: list[str] = []
    heading = ''
    tokens = MarkdownIt().enable('table').parse(path.read_text())
    for before, token in zip([tokens[0], *tokens], tokens):
        language, _, file = token.info.partition(' ')
        if token.type == 'inline':
            codes = [part.content for part in token.children or () if part.type == 'code_inline']
            mentioned += [code for code in codes if re.match(r'trawl |make |\.venv/bin/', code)]
            if before.type == 'heading_open':
                heading = token.content
        elif token.type == 'fence' and file:
            files[file] = token.content
        elif token.type == 'fence' and language in ('', 'console', 'python'):
            promises += read_block(token, name, heading)
        elif token.type in ('fence', 'code_block'):
            assert token.map is not None
            unknown.append(f'{name}:{token.map[0] + 1}: {language or "indented"}')
    return Document(name, tuple(promises), files, tuple(mentioned), tuple(unknown))


def documents() -> list[Document]:
    paths = [ROOT / 'README.md', *sorted((ROOT / 'docs').rglob('*.md'))]
    return [read_document(path) for path in paths if path != TABLE]
