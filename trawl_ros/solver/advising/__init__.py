"""Advice on refused tows, and the changes of a rigging that it may propose."""
