"""Bags of messages: written, read (also damaged ones), and made from logs of others."""
