"""The tow in time: ship, winches, sea and gear; truth comes out."""
