"""The trawl sonar: what its beams meet, what its screen shows, and what is read off it. No ROS."""
