"""Writing, reading, checking, repair and export of bags of messages."""
