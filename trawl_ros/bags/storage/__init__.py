"""Files of bags: MCAP and SQLite, also damaged ones, with their metadata."""
