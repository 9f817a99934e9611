"""Side by side with other tools: what is measured for `trawl benchmark`."""
