"""Base class of changes that an effect may be taken for."""

from abc import ABC, abstractmethod
from dataclasses import dataclass

from trawl_ros.effects.base.effect import Effect


@dataclass(frozen=True, kw_only=True)
class Change(Effect, ABC):
    """Change of the gear file or of an instrument by one size, 0 where nothing is changed.

    The size is its first value.

    Attributes
    ----------
    same_as
        Effects of the catalogue that are the same thing.
    keys
        Keys of the gear file that change; empty where it is no change of the gear file.
    relative
        True if the size is a part of what is changed, False if it is added.
    """

    same_as: tuple[str, ...] = ()
    keys: tuple[str, ...] = ()
    relative: bool = False

    @abstractmethod
    def words(self, size: float) -> str:
        """The change of a size in words."""

    @property
    def unit(self) -> str:
        """Unit of the size."""
        return self.parameters[0].unit
