"""Bench of autotrawls: the same scenarios with the project's controllers and with another one."""
