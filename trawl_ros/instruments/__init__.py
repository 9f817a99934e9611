"""Truth in, sample out: what the instruments of a trawler report, with their errors. No ROS."""
