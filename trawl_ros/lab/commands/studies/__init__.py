"""The commands of `trawl study`, one file each."""
