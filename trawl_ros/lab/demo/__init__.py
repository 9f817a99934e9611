"""`trawl demo`: tow, record, replay, identification and diagnosis in one command."""
