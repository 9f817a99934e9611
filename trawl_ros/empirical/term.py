"""What an empirical term is: an effect without physics of its own."""

from dataclasses import dataclass

from trawl_ros.effects.effect import Effect, Parameter


@dataclass(frozen=True)
class Term(Effect):
    """A force, or an error of a sensor, of a form that is dimensionally sound and no more.

    Attributes
    ----------
    reading
        The nearest physical reading, in words; never a fact.
    """

    reading: str = ''


def size(unit: str, std: float, bound: float) -> tuple[Parameter, ...]:
    """The one parameter of a term: 0 where it is not there, possible to both sides.

    ``std`` and ``bound`` are assumed: they scale the search and end it.
    """
    return (Parameter('size', unit, 0.0, -bound, bound, std),)
