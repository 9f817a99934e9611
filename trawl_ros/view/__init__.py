"""View of a tow in Rerun, in space and over time: from records to a recording and its viewer."""
