"""The trawl sonar: what its beams meet, its image, and what is read off it."""
