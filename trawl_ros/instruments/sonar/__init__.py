"""Trawl sonar: echoes in its beams, the image on its screen, and readings off it. No ROS."""
