"""Controllers of winches and rudder: samples in, commands out; no ROS."""
