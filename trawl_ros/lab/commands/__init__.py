"""The commands of the lab: `trawl validate`, `trawl benchmark`."""
