"""A trial as a file: what ship and winches do, with which gear, water and instruments."""
