"""Base class of empirical terms: effects without physics of their own."""

from dataclasses import dataclass

from trawl_ros.effects.base.effect import Effect, Parameter


@dataclass(frozen=True)
class EmpiricalTerm(Effect):
    """Empirical term: a force or sensor error of a form that is dimensionally sound and no more.

    Attributes
    ----------
    reading
        The nearest physical reading, in words; never a fact.
    """

    reading: str = ''


def size(unit: str, std: float, bound: float) -> tuple[Parameter, ...]:
    """Parameters of a term: one number, 0 where the term is absent, of either sign.

    ``std`` and ``bound`` are assumed: they scale the search and end it.
    """
    return (Parameter('size', unit, 0.0, -bound, bound, std),)
