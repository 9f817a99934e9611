"""Comparison with a net that was measured in a flume tank."""
