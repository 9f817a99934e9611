"""``trawl plot``: pictures of a bag as `trawl tow` makes it, and of one with readings alone."""

import os
import signal

import pytest
from PIL import Image

from trawl_ros.cli.console.progress import ProgressDisplay


@pytest.fixture
def bag(run, trial, tmp_path):
    done = run('tow', trial, '--out', tmp_path / 'towed')
    assert done.exit_code == 0, done.output
    return tmp_path / 'towed'


def test_a_tow_with_truth_becomes_pictures_and_a_page(run, bag, tmp_path):
    out = tmp_path / 'pictures'
    done = run('plot', bag, '--out', out, '--at', '2', '--at', '0:04', '--animate')
    assert done.exit_code == 0, done.output
    files = {path.name for path in out.iterdir()}
    assert files >= {
        'history.png', 'track.png', 'gear_00002s.png', 'gear_00004s.png', 'film.gif', 'index.html',
    }  # fmt: skip
    page = (out / 'index.html').read_text()
    for file in files - {'index.html'}:
        assert f'src="{file}"' in page
        assert f'{out / file}: ' in done.stdout
    assert '0:04' in page
    with Image.open(out / 'film.gif') as film:
        assert film.n_frames == 7


def test_names_are_text_on_the_page_and_in_pictures(run, steady_tow, tmp_path):
    bag = steady_tow.bag(tmp_path / '<script>alert(1)<$b$ \\frac', leg_s=30)
    done = run('plot', bag, '--out', tmp_path / 'a<b onmouseover="x">')
    assert done.exit_code == 0, done.output
    page = (tmp_path / 'a<b onmouseover="x">' / 'index.html').read_text()
    assert '<h1>&lt;script&gt;alert(1)&lt;$b$ \\frac</h1>' in page
    assert '<script' not in page
    assert '<b onmouseover' not in page


def test_force_replaces_a_link_and_not_what_it_leads_to(run, steady_tow, tmp_path):
    bag = steady_tow.bag(tmp_path / 'bag', leg_s=30)
    (tmp_path / 'victim').write_text('mine')
    out = tmp_path / 'pictures'
    out.mkdir()
    for name in ('index.html', 'history.png', 'gear_00015s.png'):
        (out / name).symlink_to('../victim')
    done = run('plot', bag, '--out', out, '--force')
    assert done.exit_code == 0, done.output
    assert (tmp_path / 'victim').read_text() == 'mine'
    assert not (out / 'index.html').is_symlink()


def test_readings_alone_are_drawn_and_the_page_says_so(run, steady_tow, tmp_path):
    bag = steady_tow.bag(tmp_path / 'bag', leg_s=30)
    done = run('plot', bag, '--out', tmp_path / 'pictures')
    assert done.exit_code == 0, done.output
    page = (tmp_path / 'pictures' / 'index.html').read_text()
    assert all(words in page for words in ('0:30', 'sonar/image'))
    assert 'film.gif' not in page


def test_an_interrupted_film_ends_with_what_was_drawn(run, steady_tow, tmp_path, monkeypatch):
    def interrupt(_, progress):
        if progress.stage == 'filming':
            os.kill(os.getpid(), signal.SIGINT)

    monkeypatch.setattr(ProgressDisplay, '__call__', interrupt)
    bag, out = steady_tow.bag(tmp_path / 'bag', leg_s=5), tmp_path / 'pictures'
    done = run('plot', bag, '--out', out, '--at', '2', '--animate')
    assert done.exit_code == 130
    with Image.open(out / 'film.gif') as film:
        assert film.n_frames == 1


def test_what_cannot_be_drawn_is_said_before_anything_is_written(run, steady_tow, tmp_path):
    bag, out = steady_tow.bag(tmp_path / 'bag', leg_s=5), tmp_path / 'pictures'
    for arguments, words in (
        (['--at', '1:00'], '1:00'),
        (['--at', 'soon'], "'soon'"),
        ([part for k in range(101) for part in ('--at', f'{k / 100}')],
         '101'),
        (['--gear', 'none'], 'none'),
        (['--namespace', 'other'], 'other'),
    ):  # fmt: skip
        done = run('plot', bag, '--out', out, *arguments)
        assert done.exit_code in (1, 2)
        assert words in done.stderr
        assert not out.exists()
    assert run('plot', tmp_path / 'missing', '--out', out).exit_code == 1


def test_nothing_is_written_over_unasked(run, steady_tow, tmp_path):
    bag, out = steady_tow.bag(tmp_path / 'bag', leg_s=5), tmp_path / 'pictures'
    out.mkdir()
    (out / 'history.png').write_text('mine')
    done = run('plot', bag, '--out', out)
    assert done.exit_code == 1
    assert str(out) in done.stderr
    assert (out / 'history.png').read_text() == 'mine'
    assert run('plot', bag, '--out', out, '--force').exit_code == 0
    with Image.open(out / 'history.png') as picture:
        assert picture.size[0] > 1000
