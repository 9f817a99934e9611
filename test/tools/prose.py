"""Rule of PyMarkdown for prose: words to avoid, and sentences that are too long."""

import re

from pymarkdown.general.parser_helper import ParserHelper
from pymarkdown.plugin_manager.plugin_details import PluginDetails, PluginDetailsV3
from pymarkdown.plugin_manager.plugin_scan_context import PluginScanContext
from pymarkdown.plugin_manager.rule_plugin import RulePlugin
from pymarkdown.tokens.inline_code_span_markdown_token import InlineCodeSpanMarkdownToken
from pymarkdown.tokens.markdown_token import MarkdownToken
from pymarkdown.tokens.text_markdown_token import TextMarkdownToken

LONGEST_SENTENCE_WORDS = 25

INSTEAD = {
    'anew': 'again',
    'besides?': 'next to, together with, compared with, or also',
    'by script': 'the command that prints it',
    'comes? to rest': 'converge, or reach a steady state',
    'earns? (its|their) place': 'is used, or leave it out',
    'found and mended': 'fixed',
    'not to be had': 'not available',
    'tells(?! apart)': 'report, show or say',
    'told(?! apart)': 'reported, said or given',
}
"""Patterns of words to avoid, and what to write in their place."""

SENTENCE_END = re.compile(r'(?<=[.!?])[)"”*]*\s+(?=[A-Z(“"*§])|[:;]\s')
WORD = re.compile(r'[^\W\d_]{2}')
"""Symbols and numbers are no words: equations stand in sentences."""


class Prose(RulePlugin):
    """Check paragraphs, headings, list items and cells of tables; code counts as one word."""

    def __init__(self) -> None:
        super().__init__()
        self._block: MarkdownToken | None = None
        self._text = ''

    def get_details(self) -> PluginDetails:
        """Return the name under which the rule is reported."""
        return PluginDetailsV3(
            plugin_name='prose',
            plugin_id='TRW001',
            plugin_enabled_by_default=True,
            plugin_description='Prose',
            plugin_version='1.0.0',
        )

    def starting_new_file(self) -> None:
        """Forget the file before."""
        self._block = None

    def next_token(self, context: PluginScanContext, token: MarkdownToken) -> None:
        """Collect the text of a block, and check it where the block ends."""
        if starts_block(token):
            self._block, self._text = token, ''
        elif self._block is not None:
            if ends_block(token):
                for complaint in complaints(self._text):
                    self.report_next_token_error(
                        context, self._block, extra_error_information=complaint
                    )
                self._block = None
            elif isinstance(token, TextMarkdownToken):
                self._text += ParserHelper.resolve_all_from_text(token.token_text)
            elif isinstance(token, InlineCodeSpanMarkdownToken):
                self._text += 'Code'


def starts_block(token: MarkdownToken) -> bool:
    """Return whether text of one block follows."""
    return (
        token.is_paragraph
        or token.is_atx_heading
        or token.is_table_header_item
        or token.is_table_row_item
    )


def ends_block(token: MarkdownToken) -> bool:
    """Return whether the text of a block is complete."""
    return (
        token.is_paragraph_end
        or token.is_atx_heading_end
        or token.is_table_header_item_end
        or token.is_table_row_item_end
    )


def complaints(text: str) -> list[str]:
    """List what is wrong with a block of text."""
    text = ' '.join(text.split())
    found = [
        f'"{match[0]}": write {advice}'
        for pattern, advice in INSTEAD.items()
        for match in re.finditer(rf'\b{pattern}\b', text, re.IGNORECASE)
    ]
    for sentence in SENTENCE_END.split(text):
        words = [word for word in sentence.split() if WORD.search(word)]
        if len(words) > LONGEST_SENTENCE_WORDS:
            found.append(f'{len(words)} words: {" ".join(words[:6])} …')
    return found
