"""The report of the lab has every row, tells what is missed, and keeps foreign text as text."""

import json
from itertools import pairwise

from matplotlib.figure import Figure

from trawl_ros.lab.report.measured import MeasuredValue, at_least, at_most
from trawl_ros.lab.report.page import Page, Section, TextTable, write_page
from trawl_ros.report.pictures import Drawing, Picture

SECTIONS = [
    Section('Speed', [MeasuredValue('steps', 5.0, '1/s', at_least(9.0), 'a <slow> | machine')]),
    Section(
        'Warp', [MeasuredValue('error', 1.0, 'm', at_most(2.0), low=0.5, high=1.5)],
        [Picture('figures/warp.png', 'The warp.')],
        [TextTable('Both.', ('a', 'b'), (('1', 'no'),))],
        'Of the warp.', 'Lines', command='trawl validate warp', seconds=3.2,
    ),
    Section('Nothing'),
]  # fmt: skip


def test_a_report_without_an_answer_begins_with_its_first_value(tmp_path):
    write_page(tmp_path, Page('study', 'A study', 'trawl study', 'It was measured.'), SECTIONS)
    assert '**Steps: 5 1/s. 1 of 2 targets are reached.**' in (tmp_path / 'study.md').read_text()


def test_a_report_is_written_in_three_forms(tmp_path):
    page = Page('study', 'A study', 'trawl study', 'It was measured.', answer='It is fast.')
    rows = write_page(tmp_path / 'out', page, SECTIONS, [Drawing('study', 'All.', Figure())])
    names = ['study.html', 'study.json', 'study.md', 'study.png']
    assert sorted(file.name for file in (tmp_path / 'out').iterdir()) == names
    record = json.loads((tmp_path / 'out' / 'study.json').read_text())
    assert [row['what'] for row in record['rows']] == [row.what for row in rows]
    lines = (tmp_path / 'out' / 'study.md').read_text().splitlines()
    for line in (
        '**It is fast. 1 of 2 targets are reached.**',
        '<summary>0 of 1 targets are reached.</summary>',
        'It was measured.', 'Made by `trawl study` of trawl_ros',
        '| Speed | steps | 5 1/s | ≥ 9 1/s | a <slow> \\| machine |',
        '| what | value | asked for | reached | note |',
        '| steps | 5 1/s | ≥ 9 1/s | **no** | a <slow> \\| machine |',
        '## Lines', '### Warp', '| what | value | low | high | asked for | reached |',
        '| error | 1 m | 0.5 | 1.5 | ≤ 2 m | yes |', '| 1 | **no** |',
        '![The warp.](figures/warp.png)', '`trawl validate warp` took 3 s.', '![All.](study.png)',
    ):  # fmt: skip
        assert any(found.startswith(line) for found in lines), line
    assert not any('Nothing' in line for line in lines)
    # The picture of the first section that has one stands above all sections.
    assert lines.index('![The warp.](figures/warp.png)') < lines.index('## Speed')
    # A table, a heading or a picture needs an empty line before it.
    for before, line in pairwise(lines):
        if line.startswith(('#', '![', '| what', '| where', '| a ')):
            assert before == '', line
    html = (tmp_path / 'out' / 'study.html').read_text()
    assert 'a &lt;slow&gt; | machine' in html
    assert '<td class="misses">no</td>' in html
    assert 'src="figures/warp.png"' in html
    assert 'src="data:image/png;base64,' in html


def test_the_section_that_answers_comes_before_what_is_missed(tmp_path):
    sections = [
        *SECTIONS,
        Section('Sea', [MeasuredValue('off', 2.0, 'm')], group='Hauls', name='sea'),
    ]
    page = Page('study', 'A study', 'trawl study', 'It was measured.', lead='sea')
    write_page(tmp_path, page, sections)
    wanted = {
        'md': ('### Sea', 'Targets that are not', '## Speed'),
        'html': ('>Sea</h3>', 'Targets that are not', '>Speed</h2>'),
    }
    for kind, heads in wanted.items():
        text = (tmp_path / f'study.{kind}').read_text()
        places = [text.index(head) for head in heads]
        assert places == sorted(places)
        assert text.count(heads[0]) == 1
