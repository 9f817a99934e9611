"""The tool that counts lines of code leaves out what is none."""

import count_code

TEXT = '''"""Say what is in it.

At length.
"""

import sys
from os import (
    path,
)

LIMIT = 3
"""Number of things."""

# A remark.


def join(parts):
    """Join parts."""
    text = """two
lines"""  # with a remark
    return (
        text, parts
    )
'''


def test_docstrings_comments_blanks_and_imports_are_no_code():
    assert count_code.lines_of_code(TEXT) == 7


def test_a_folder_is_counted_with_all_below_it(tmp_path, capsys):
    (tmp_path / 'inner').mkdir()
    (tmp_path / 'a.py').write_text(TEXT)
    (tmp_path / 'inner' / 'b.py').write_text('x = 1\n\n')
    assert count_code.count_folder(tmp_path) == count_code.Count(2, 25, 8)
    count_code.main([tmp_path, tmp_path / 'inner'])
    assert capsys.readouterr().out.splitlines()[-1].split() == ['sum', '3', '27', '9']
