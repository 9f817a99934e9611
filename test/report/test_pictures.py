"""Pictures are written whole into the folder of a page, or into the page itself."""

import base64

from matplotlib.figure import Figure

from trawl_ros.report.pictures import Drawing, Picture, by_section, draw, embedded


def test_drawings_become_files_and_then_text(tmp_path):
    (tmp_path / 'mine.png').write_bytes(b'mine')
    (tmp_path / 'figures').mkdir()
    (tmp_path / 'figures' / 'case_speed.png').symlink_to(tmp_path / 'mine.png')
    drawn = draw(tmp_path, [Drawing('speed', 'Speed.', Figure(), 'Motion')], 'figures/case_')
    assert drawn == (Picture('figures/case_speed.png', 'Speed.', 'Motion'),)
    written = (tmp_path / 'figures' / 'case_speed.png').read_bytes()
    assert written.startswith(b'\x89PNG')
    assert (tmp_path / 'mine.png').read_bytes() == b'mine'
    (picture,) = embedded(tmp_path, drawn)
    head, _, text = picture.file.partition(',')
    assert head == 'data:image/png;base64'
    assert base64.b64decode(text) == written


def test_headings_stand_in_the_order_in_which_they_come():
    pictures = [Picture(name, '', section) for name, section in ('aY', 'bX', 'cY')]
    assert list(by_section(pictures)) == ['Y', 'X']
    assert [picture.file for picture in by_section(pictures)['Y']] == ['a', 'c']
