"""The files of the package name their licence, all of them as soon as one does."""

from licence import HEADER, files, without

from trawl_ros.core.resources import share_path


def test_all_files_name_the_licence_or_none():
    missing = without()
    assert not missing or missing == files(), '`python test/tools/licence.py` adds what is missing'


def test_it_is_the_licence_of_the_package():
    assert 'Apache-2.0' in HEADER
    assert '>Apache-2.0</license>' in share_path('package.xml').read_text(encoding='utf-8')
