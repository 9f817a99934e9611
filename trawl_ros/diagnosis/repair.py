"""Repaired gear file with the effect in it."""

from collections.abc import Sequence
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path

import yaml

from trawl_ros.core.version import __version__
from trawl_ros.diagnosis.diagnosis import Diagnosis, values_of
from trawl_ros.diagnosis.refit import Refit
from trawl_ros.diagnosis.weighing import Weighed
from trawl_ros.gear.boards import CoefficientsRecord
from trawl_ros.gear.records import EffectRecord, GearRecord, ProvenanceRecord, SourceRecord

RECORDINGS = ('.mcap', '.db3', '.csv')
PIECE = 1 << 20


@dataclass(frozen=True)
class SourceBag:
    """Source: a bag and the SHA-256 of its recordings."""

    bag: str
    sha256: str


def source(bag: Path) -> SourceBag:
    """Identify a bag by the SHA-256 of its recordings, in the order of their names."""
    files = sorted(bag.rglob('*')) if bag.is_dir() else [bag]
    recordings = [file for file in files if file.suffix in RECORDINGS and file.is_file()]
    digests = []
    for file in recordings:
        digest = sha256()
        with file.open('rb') as stream:
            while piece := stream.read(PIECE):
                digest.update(piece)
        digests.append(digest.hexdigest())
    return SourceBag(bag.name, ' '.join(digests) or 'no recordings')


def repaired(diagnosis: Diagnosis, sources: Sequence[SourceBag]) -> GearRecord | None:
    """The gear with boards as refitted and in it the effect that is named, or two, or an empirical
    term.

    None where nothing has been named and no term does: a gear file is to hold what is known.
    """
    best = diagnosis.repair
    if best is None:
        return None
    return with_refitted_effects(diagnosis.gear, best.refit, _provenance(best, sources))


def with_refitted_effects(gear: GearRecord, refit: Refit, origin: ProvenanceRecord) -> GearRecord:
    """Gear with the boards and effects of a refit."""
    board = refit.fit.prior.unpacked(refit.estimate.values, 'coefficients')
    taken = set(refit.names)
    effects = tuple(effect for effect in gear.effects if effect.name not in taken)
    effects += tuple(
        EffectRecord(
            name=name,
            values={parameter: value for parameter, (value, *_) in values.items()},
            provenance=origin,
        )
        for name, values in values_of(refit).items()
    )
    if gear.pair is not None:
        return gear.model_copy(update={'effects': effects})
    coefficients = CoefficientsRecord(**board)
    return gear.model_copy(
        update={
            'board': gear.board.model_copy(update={'coefficients': coefficients}),
            'effects': effects,
        }
    )


def _provenance(best: Weighed, sources: Sequence[SourceBag]) -> ProvenanceRecord:
    return ProvenanceRecord(
        found_by=f'trawl diagnose {__version__}',
        bags=tuple(SourceRecord(bag=bag.bag, sha256=bag.sha256) for bag in sources),
        evidence={
            'delta_chi2': best.delta_chi2,
            'delta_bic': best.delta_bic,
            'held_out_gain': best.gain[0],
            'bootstrap_share': best.share,
        },
    )


def gear_text(gear: GearRecord) -> str:
    """Text of a gear file."""
    plain = gear.model_dump(mode='json', exclude_none=True)
    return yaml.safe_dump(plain, sort_keys=False, allow_unicode=True, width=100)
