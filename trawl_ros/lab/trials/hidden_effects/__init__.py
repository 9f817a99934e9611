"""Effects hidden in blind cases, inside and outside the catalogue."""
