"""Records that flow between rooms: truth, samples, channels, the table of topics."""
