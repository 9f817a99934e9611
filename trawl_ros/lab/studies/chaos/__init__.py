"""Fault injection in the ROS graph: nodes stopped, killed or disturbed, full disks, wild clocks."""
