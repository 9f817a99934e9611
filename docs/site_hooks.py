"""Pages of the site from files at the root of the repository, whose links are as they are there."""

import re
from pathlib import Path

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

from trawl_ros.core.limits import TABLE
from trawl_ros.records.topics import TOPICS, Topic

ROOT = Path(__file__).parents[1]
PAGES = {
    'README.md': 'overview.md',
    'CONTRIBUTING.md': 'contributing.md',
    'CHANGELOG.md': 'changelog.md',
}
"""Page of the site by file."""


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the pages."""
    for name, page in PAGES.items():
        text = (ROOT / name).read_text().replace('](docs/', '](')
        files.append(File.generated(config, page, content=text))
    files.append(File.generated(config, 'reference/topics.md', content=topics()))
    files.append(File.generated(config, 'reference/limits.md', content=limits()))
    return files


def topics() -> str:
    """Write the page of all topics from the registry."""
    rows = ''.join(map(_row, TOPICS.values()))
    return (
        '# Topics\n\n'
        'Nodes that play, record or show every topic, and an operator, are not named.\n\n'
        '| topic | type | frame | published by | heard by | content |\n|---|---|---|---|---|---|\n'
        f'{rows}'
    )


def limits() -> str:
    """Write the page of the limits of foreign files and messages."""
    rows = ''.join(f'| `{name}` | {limit} | {limit.what} |\n' for name, limit in TABLE.items())
    return f'# Limits of input\n\n| limit | at most | of what |\n|---|---|---|\n{rows}'


def _row(topic: Topic) -> str:
    cells = (
        f'`{topic.name}`',
        topic.type.replace('/msg/', '/'),
        topic.frame,
        ', '.join(topic.published_by),
        ', '.join(topic.heard_by),
        topic.sentence,
    )
    return f'| {" | ".join(cells)} |\n'


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Lead links to those files to their pages, and set names of files over their blocks."""
    markdown = re.sub(r'^```(\w+) (\S+)$', r'```\1 title="\2"', markdown, flags=re.M)
    return re.sub(
        rf'\]\(((?:\.\./)*)\.\./({"|".join(PAGES)})',
        lambda link: f']({link[1]}{PAGES[link[2]]}',
        markdown,
    )


def on_page_content(html: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Let names of topics and types in tables break after their slashes, and nowhere else."""
    return re.sub(
        r'<td[ >].*?</td>',
        lambda cell: re.sub(r'(?<=[\w}])/(?=[\w{])(?![^<]*>)', '/<wbr>', cell[0]),
        html,
        flags=re.DOTALL,
    )
