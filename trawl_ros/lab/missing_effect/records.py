# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Records of the benchmark: the trials, their key, and the answers of a method."""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from trawl_ros.core.schema import Numbers, Record
from trawl_ros.diagnosis.inference.decision import Verdict
from trawl_ros.lab.trials.trial import Form, Series

NOTHING, SOMETHING_ELSE = 'nothing', 'something_else'
"""Names of a probability that no path of the library has."""

Probability = Annotated[float, Field(ge=0.0, le=1.0)]


class TrialRecord(Record):
    """Trial as a method sees it.

    Attributes
    ----------
    name
        Name of its folder.
    tows
        Names of the tows in their order; bags have these names.
    baseline
        Number of first tows with the gear in order.
    """

    name: str
    tows: tuple[str, ...]
    baseline: Annotated[int, Field(ge=0)]


class HypothesisRecord(Record):
    """Hypothesis of the library: path of its node, its name, meaning and parameters."""

    path: str
    sentence: str
    check: str
    parameters: dict[str, str]


class TrialsRecord(Record):
    """Content of ``trials.json``, all that a method may read, except the data.

    Attributes
    ----------
    format
        Version of the format.
    form
        Form of the data.
    key_sha256
        SHA-256 of the file with the key, which holds before anybody answers.
    trials, hypotheses
        All trials, and all names that an answer may have.
    """

    format: Literal[1]
    form: Form
    key_sha256: str
    trials: tuple[TrialRecord, ...]
    hypotheses: tuple[HypothesisRecord, ...]

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the trials."""
        return tuple(trial.name for trial in self.trials)


class CauseRecord(Record):
    """Hidden cause.

    Attributes
    ----------
    name, size, unit
        The cause, and its size.
    leaves, nodes
        Names of the leaves, and paths of the nodes, that are right.
    sizes
        True value of each right leaf whose size can be compared.
    """

    name: str
    size: float
    unit: str
    leaves: tuple[str, ...]
    nodes: tuple[str, ...]
    sizes: Numbers

    def has_leaf(self, path: str) -> bool:
        """Return True if a path is a right leaf."""
        return path.rpartition('/')[2] in self.leaves


class TruthRecord(Record):
    """Truth of a trial.

    Attributes
    ----------
    series
        Nothing hidden, one cause, one outside the library, or two.
    strength
        Strength of each cause, in smallest detectable sizes.
    causes
        All hidden causes.
    coefficients
        Board coefficients (12,) of the plant.
    floor
        RMS errors by channel, on held-out windows, of the plant itself as a model.
    """

    series: Series
    strength: float
    causes: tuple[CauseRecord, ...] = ()
    coefficients: tuple[float, ...] = ()
    floor: Numbers = Field(default_factory=dict)

    @property
    def words(self) -> str:
        """Names of the hidden causes."""
        return '+'.join(cause.name for cause in self.causes) or 'nothing'

    def holds(self, path: str) -> bool:
        """Return True if a leaf or node holds one of the hidden causes."""
        return any(
            cause.has_leaf(path) or any(f'{node}/'.startswith(f'{path}/') for node in cause.nodes)
            for cause in self.causes
        )


class KeyRecord(Record):
    """Key of all trials: their draw, their truth, and why other numbers could not be made."""

    seed: int
    gear: str
    form: Form
    trials: dict[str, TruthRecord]
    not_possible: dict[str, str]


class SizeRecord(Record):
    """Size of a cause with its 95 % interval, in the unit of the hypothesis."""

    value: float
    low: float
    high: float

    @model_validator(mode='after')
    def _ordered(self) -> 'SizeRecord':
        if not self.low <= self.high:
            raise ValueError(f'low: found {self.low:g}, expected at most high, {self.high:g}')
        return self


class HeldOutRecord(Record):
    """RMS errors by channel on held-out windows, without and with the repair, and as expected."""

    before: Numbers
    after: Numbers
    expected: Numbers


class CoefficientsRecord(Record):
    """Board coefficients (12,) without and with the named causes, and their std."""

    before: tuple[float, ...]
    after: tuple[float, ...]
    std: tuple[Annotated[float, Field(gt=0.0)], ...]


class AnswerRecord(Record):
    """Answer to one trial.

    Attributes
    ----------
    verdict
        One of the verdicts of `trawl diagnose`.
    named
        Paths of the leaves or nodes that are named, with the verdict NAMED alone.
    among
        Paths of the leaves that are not excluded.
    probabilities
        Of `nothing`, `something_else`, and paths of leaves and nodes.
    sizes
        By path of a leaf with one parameter.
    held_out, coefficients
        Errors and boards with the repair, where the method has one.
    seconds
        Processor time, s.
    """

    verdict: Verdict
    named: tuple[str, ...] = ()
    among: tuple[str, ...] = ()
    probabilities: dict[str, Probability] = Field(default_factory=dict)
    sizes: dict[str, SizeRecord] = Field(default_factory=dict)
    held_out: HeldOutRecord | None = None
    coefficients: CoefficientsRecord | None = None
    seconds: Annotated[float, Field(ge=0.0)] | None = None

    @model_validator(mode='after')
    def _consistent(self) -> 'AnswerRecord':
        if bool(self.named) != (self.verdict == 'NAMED'):
            raise ValueError(
                f'named: found {len(self.named)} names with the verdict {self.verdict}, expected '
                'names with NAMED and none with another verdict'
            )
        whole = self.of(NOTHING) + self.of(SOMETHING_ELSE)
        if whole > 1.0 + 1e-6:
            raise ValueError(
                f'probabilities: found {whole:g} for {NOTHING} and {SOMETHING_ELSE} together, '
                'expected at most 1'
            )
        return self

    @property
    def paths(self) -> set[str]:
        """All paths that the answer has."""
        own = {*self.named, *self.among, *self.probabilities, *self.sizes}
        return own - {NOTHING, SOMETHING_ELSE}

    def of(self, path: str) -> float:
        """Return a probability; a node without one has the sum of those below it, at most 1."""
        if path in self.probabilities:
            return self.probabilities[path]
        below = [own for own in self.probabilities if own.startswith(f'{path}/')]
        top = [own for own in below if not any(own.startswith(f'{other}/') for other in below)]
        return min(1.0, sum(self.probabilities[own] for own in top))


class AnswersRecord(Record):
    """File of answers: name of the method, and an answer to each trial."""

    method: str
    trials: dict[str, AnswerRecord]
