"""Studies: long runs of the whole chain, and what they show; ``make study NAME=...`` runs one."""
