"""Advice on refused tows, and the changes of a rigging that it is sought among."""
