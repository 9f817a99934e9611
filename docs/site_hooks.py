"""Pages of the site from files at the root of the repository, whose links are as they are there."""

import re
from pathlib import Path

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

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
    return files


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Lead links to those files to their pages, and set names of files over their blocks."""
    markdown = re.sub(r'^```(\w+) (\S+)$', r'```\1 title="\2"', markdown, flags=re.M)
    return re.sub(
        rf'\]\(((?:\.\./)*)\.\./({"|".join(PAGES)})',
        lambda link: f']({link[1]}{PAGES[link[2]]}',
        markdown,
    )
