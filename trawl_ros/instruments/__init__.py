"""Instruments of a trawler: truth in, samples with errors out; no ROS."""
