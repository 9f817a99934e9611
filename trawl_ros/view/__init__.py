"""View of a tow in Rerun, in space and over time: records, recording and viewer."""
