"""The table of docs/sentences.md is drawn from the files that the code reads.

`python test/sentences/test_document.py` draws it anew.
"""

import re
from pathlib import Path

from trawl_ros.core.units import UNITS
from trawl_ros.sentences.codec import SentenceReader
from trawl_ros.sentences.framing import parse_line
from trawl_ros.sentences.table import (
    SentenceField,
    SentenceRow,
    load_table,
    packaged_systems,
)

DOCUMENT = Path(__file__).parents[2] / 'docs' / 'sentences.md'
HEAD, FOOT = '<!-- sentences -->', '<!-- /sentences -->'


def picture(row: SentenceRow) -> str:
    """Row as manuals print it: numbers as x.x, what is passed over as an ellipsis."""
    texts = [row.address, *(sign(field) for field in row.fields)]
    return row.start + row.separator.join(texts) + ('*hh' if row.checksum != 'no' else '')


def sign(field: SentenceField) -> str:
    if field.reading is not None:
        decimals = '.' + 'x' * field.decimals if field.decimals else ''
        return 'x' * max(field.digits, 1) + decimals + field.suffix
    if field.any is not None:
        return '…' if field.any else ''
    if field.keel_offset is not None:
        return 'x.x'
    if field.text is not None:
        return field.text
    signs = {'latitude': 'N', 'longitude': 'E'}
    return field.status or field.time or field.date or signs[field.hemisphere or '']


def rows() -> list[str]:
    """Lines of the table, one per reading."""
    lines = [
        '| system | sentence | reading | unit, step | at most every | source | assumed |',
        '|---|---|---|---|---|---|---|',
    ]
    for system in packaged_systems():
        table = load_table(system)
        for row in table.sentences.values():
            form = f' (read only: {row.form})' if row.form else ''
            front = f'| `{system}` | `{picture(row)}`{form}'
            rate = f'{row.least_interval_s:g} s ({row.rate_source})' if row.rate_source else ''
            back = f'{rate} | {row.source} | {row.assumed}'
            if not row.topics:
                said = 'passed over' if row.passed_over else 'date and time'
                lines.append(f'{front} | {said} | | {back} |')
            for field in (field for field in row.fields if field.reading):
                step = f'{UNITS[field.unit].name}, {10.0**-field.decimals:g}'
                flipped = ', other sign' if field.scale < 0 else ''
                lines.append(f'{front} | `{field.reading}` | {step}{flipped} | {back} |')
                front, back = '| |', '| |'
    return lines


def drawn(text: str) -> str:
    """The document with its table as it should be."""
    before, _, rest = text.partition(HEAD)
    table = '\n'.join(rows())
    return f'{before}{HEAD}\n{table}\n{FOOT}{rest.partition(FOOT)[2]}'


def test_the_table_is_that_of_the_files_that_the_code_reads():
    text = DOCUMENT.read_text('utf-8')
    assert text == drawn(text), 'python test/sentences/test_document.py draws it anew'


def test_the_sentence_of_ones_own_reads_what_that_ship_sent(tmp_path):
    path = tmp_path / 'winch_1.yaml'
    path.write_text(
        re.search(r'```yaml winch_1.yaml\n(.*?)```', DOCUMENT.read_text('utf-8'), re.S)[1]
    )
    # On the page that the document names.
    frame = parse_line(b'@RCWD,1,0,-39.45,0.00,0.00,0,-43.83,0.000000*2a')
    assert SentenceReader([load_table(path)]).read(frame).readings == {
        ('winch/joint_states', 'port_speed'): 0.0,
        ('winch/joint_states', 'port_length'): -43.83,
        ('winch/joint_states', 'port_tension'): 0.0,
    }


def test_the_guides_set_points_are_read():
    guide = (DOCUMENT.parent / 'guides/sentences.md').read_text('utf-8')
    reader = SentenceReader([load_table('set_points')])
    block = re.search(r'```text set_points.nmea\n(.*?)```', guide, re.DOTALL)[1]
    names = [reader.read(parse_line(line.encode())).name for line in block.splitlines()]
    assert names == ['warps', 'ship']


if __name__ == '__main__':
    DOCUMENT.write_text(drawn(DOCUMENT.read_text('utf-8')), 'utf-8')
