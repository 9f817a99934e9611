"""Rejections: counts by reason, with the last finding of each."""

from collections import Counter


class Rejections:
    """Rejections: counts and sentences by reason, a key of `REASONS`.

    Attributes
    ----------
    counts : Counter
        Reason → how often.
    sentences : dict
        Reason → what was found last, in one sentence.
    """

    def __init__(self) -> None:
        self.counts: Counter[str] = Counter()
        self.sentences: dict[str, str] = {}

    def add(self, reason: str, sentence: str, number: int = 1) -> None:
        """Count ``number`` rejections, which the sentence describes."""
        self.counts[reason] += number
        self.sentences[reason] = sentence
