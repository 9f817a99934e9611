"""Conversion between records and ROS messages, and encoding of messages as CDR bytes."""
