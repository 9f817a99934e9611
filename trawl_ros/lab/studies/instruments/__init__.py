"""The study of instruments beside measured ones."""
