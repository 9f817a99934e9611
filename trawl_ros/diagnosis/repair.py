# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Repaired gear file with the effect in it."""

from collections.abc import Sequence
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path

import yaml

from trawl_ros.core.version import __version__
from trawl_ros.diagnosis.diagnosis import Diagnosis, values_of
from trawl_ros.diagnosis.inference.posterior import Explanation
from trawl_ros.diagnosis.library.drift import Drift
from trawl_ros.diagnosis.library.gear_file_change import GearFileChange, changed
from trawl_ros.gear.board_parameters import CoefficientsRecord
from trawl_ros.gear.records import EffectRecord, GearRecord, ProvenanceRecord, SourceRecord

RECORDING_SUFFIXES = ('.mcap', '.db3', '.csv')
READ_BYTES = 1 << 20


@dataclass(frozen=True)
class SourceBag:
    """Source: a bag and the SHA-256 of its recordings."""

    bag: str
    sha256: str


def source(bag: Path) -> SourceBag:
    """Identify a bag by the SHA-256 of its recordings, in the order of their names."""
    files = sorted(bag.rglob('*')) if bag.is_dir() else [bag]
    recordings = [file for file in files if file.suffix in RECORDING_SUFFIXES and file.is_file()]
    digests = []
    for file in recordings:
        digest = sha256()
        with file.open('rb') as stream:
            while piece := stream.read(READ_BYTES):
                digest.update(piece)
        digests.append(digest.hexdigest())
    return SourceBag(bag.name, ' '.join(digests) or 'no recordings')


def repaired(diagnosis: Diagnosis, sources: Sequence[SourceBag]) -> GearRecord | None:
    """Return the gear with boards as refitted and in it what is named.

    None where nothing has been named, or a gear file cannot hold it: a drift of an instrument, or
    ropes of one side that differ.
    """
    best = diagnosis.repair
    if best is None or best.refit is None:
        return None
    for suspect in best.suspects:
        effect = suspect.entry.effect
        if isinstance(effect, Drift):
            return None
        if isinstance(effect, GearFileChange) and effect.side is not None:
            return None
    return _with_causes(diagnosis, best, sources)


def _with_causes(
    diagnosis: Diagnosis, best: Explanation, sources: Sequence[SourceBag]
) -> GearRecord:
    """Gear with the boards and causes of an explanation."""
    assert best.refit is not None
    gear, refit = diagnosis.gear, best.refit
    board = refit.fit.prior.unpacked(refit.estimate.values, 'coefficients')
    delta_chi2, delta_bic = diagnosis.lowered(best)
    origin = ProvenanceRecord(
        found_by=f'trawl diagnose {__version__}',
        bags=tuple(SourceRecord(bag=bag.bag, sha256=bag.sha256) for bag in sources),
        evidence={
            'delta_chi2': delta_chi2,
            'delta_bic': delta_bic,
            'log_bayes_factor': best.log_factor,
            'probability': min(own.probability for own in diagnosis.named),
        },
    )
    effects: list[EffectRecord] = []
    for suspect, values in zip(best.suspects, values_of(best).values(), strict=True):
        effect = suspect.entry.effect
        sizes = {name: value for name, (value, *_) in values.items()}
        if isinstance(effect, GearFileChange):
            gear = changed(gear, effect.record, sizes['change'])
        else:
            effects.append(EffectRecord(name=effect.name, values=sizes, provenance=origin))
    taken = {effect.name for effect in effects}
    kept = [effect for effect in gear.effects if effect.name not in taken]
    gear = gear.model_copy(update={'effects': (*kept, *effects)})
    if gear.pair is not None:
        return gear
    coefficients = CoefficientsRecord(**board)
    return gear.model_copy(
        update={'board': gear.board.model_copy(update={'coefficients': coefficients})}
    )


def gear_text(gear: GearRecord) -> str:
    """Text of a gear file."""
    plain = gear.model_dump(mode='json', exclude_none=True)
    return yaml.safe_dump(plain, sort_keys=False, allow_unicode=True, width=100)
