"""The trawl sonar: echoes in its beams, its image, and readings from it."""
