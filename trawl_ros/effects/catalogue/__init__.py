"""The known effects, one file each, with its `EFFECT`."""
