"""Reading and writing of sentences of ships' instruments, by a table in YAML."""
