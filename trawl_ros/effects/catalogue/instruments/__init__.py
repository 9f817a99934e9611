"""Effects of instruments: their errors."""
