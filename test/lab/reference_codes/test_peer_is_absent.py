"""A peer that is not installed."""

import subprocess
import sys

import pytest

from trawl_ros.lab.reference_codes.absent import PeerAbsent, peer


def test_the_sentence_names_the_program_and_the_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, 'moordyn', None)
    with pytest.raises(PeerAbsent, match=r'moordyn is not installed.*trawl_ros\[peers\]'):
        peer('moordyn')


def test_peers_are_not_imported_before_they_are_asked_for() -> None:
    code = (
        'import sys, trawl_ros.lab.reference_codes.moordyn;'
        'import trawl_ros.lab.reference_codes.moorpy_wire;'
        'assert not {"moordyn", "moorpy"} & set(sys.modules)'
    )
    subprocess.run([sys.executable, '-c', code], check=True)
