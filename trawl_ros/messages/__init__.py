"""The one boundary between records and ROS messages, and their bytes (CDR)."""
