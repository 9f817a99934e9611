"""The one boundary between the project's records and ROS messages."""
