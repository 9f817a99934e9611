"""The known effects by what they act on, each file with its `EFFECT` or `EFFECTS`."""
