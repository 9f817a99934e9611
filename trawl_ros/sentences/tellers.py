"""One teller for each topic: of two that say the same, the first is believed while it speaks."""

from collections.abc import Iterable

from trawl_ros.core.time import SECOND
from trawl_ros.sentences.codec import Spoken

SILENT_NS = 15 * SECOND
"""Silence (ns) after which another teller is believed: acoustic sensors speak every few seconds."""


class Tellers:
    """Choice of one source for each topic, among links, senders, systems, talkers and forms."""

    def __init__(self) -> None:
        self._told: dict[str, tuple[tuple[str, str, str], int]] = {}

    def rival(self, spoken: Spoken, link: str, form: str, now: int) -> str:
        """Name the source that is believed instead of that of a sentence; empty if that one is.

        Parameters
        ----------
        spoken
            The sentence.
        link
            Name of the link it came by, with the sender where several can speak on it.
        form
            Form of its row.
        now
            Monotonic time, ns.
        """
        source = (link, spoken.system, f'{spoken.talker} {form}')
        topics = _topics(spoken)
        for topic in topics:
            owner, heard = self._told.get(topic, (source, now))
            if owner != source and now - heard < SILENT_NS:
                return ' '.join(owner)
        for topic in topics:
            self._told[topic] = (source, now)
        return ''


def _topics(spoken: Spoken) -> Iterable[str]:
    return {topic for topic, _ in spoken.readings}
