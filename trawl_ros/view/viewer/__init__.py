"""Rerun itself: its library, its program as a process with its ports, and its page in a browser."""
