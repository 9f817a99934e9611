"""ROS nodes, one file per executable; no physics."""
