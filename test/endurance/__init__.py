"""Long tests of nodes and model: soak, faults in the graph, hostile messages, random commands."""
