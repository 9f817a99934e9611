"""Faults in the ROS graph: nodes stopped, killed or disturbed, full disks, wrong clocks."""
