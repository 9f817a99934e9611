"""The known effects by what they act on, each file with its `EFFECTS`."""
