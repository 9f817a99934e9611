"""Sentences of ships' instruments, read and written by a table in YAML."""
