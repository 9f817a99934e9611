"""Bags of messages: writing, reading (also of damaged ones), and import of foreign logs."""
