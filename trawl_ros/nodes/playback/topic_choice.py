"""Choice of topics: those of the project, those named, those whose names match, or all."""

from collections.abc import Collection, Mapping
from typing import Any

from trawl_ros.core.errors import TrawlError

ALL = 'all'


class TopicChoice:
    """Predicate of full topic names.

    Parameters
    ----------
    project
        The project's own, wanted where nothing else is.
    named
        Full names; ``{'all'}`` stands for every topic.
    patterns
        Expressions of RE2 by parameter: ``regex`` adds the topics in whose names it is found,
        ``exclude_regex`` takes such away; '' is none.
    never
        Full names that are never wanted.

    Raises
    ------
    TrawlError
        If an expression is none.
    """

    def __init__(
        self,
        project: Collection[str],
        named: Collection[str],
        patterns: Mapping[str, str],
        never: Collection[str],
    ) -> None:
        compiled = {name: _compiled(name, pattern) for name, pattern in patterns.items()}
        self._added, self._left_out = compiled.get('regex'), compiled.get('exclude_regex')
        self._everything = ALL in named
        self._named = frozenset(named) if named or self._added else frozenset(project)
        self._never = frozenset(never)

    def __contains__(self, topic: Any) -> bool:
        if topic in self._never or (self._left_out and self._left_out.search(topic)):
            return False
        if self._everything or topic in self._named:
            return True
        return self._added is not None and self._added.search(topic) is not None


def _compiled(parameter: str, pattern: str) -> Any:
    """Compile an expression whose search takes a time in proportion to the name's length.

    Other nodes choose names of topics: Python's own expressions may take years for one.
    """
    if not pattern:
        return None
    import re2  # only where it is needed, as it is by few

    options = re2.Options()
    options.log_errors = False
    try:
        return re2.compile(pattern, options)
    except re2.error as reason:
        (words,) = reason.args
        raise TrawlError(
            f'parameter {parameter}: found {pattern!r}, expected a regular expression of RE2, '
            f'which has no look-around and no back-references ({words.decode()})'
        ) from None
