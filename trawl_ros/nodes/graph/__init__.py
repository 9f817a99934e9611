"""The graph as ROS 2 shows it: discovery, publishers, quality of service, security."""
