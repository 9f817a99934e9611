"""Files of bags: MCAP and SQLite, also damaged, with their metadata."""
