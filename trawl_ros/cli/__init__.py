"""The command `trawl`, one file per sub-command."""
