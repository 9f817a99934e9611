"""Trial that runs itself: its states, limits, transits, and what it keeps through a restart."""
