"""Emulated instruments of a trawler: truth in, samples with errors out. No ROS."""
