"""Common ground of all nodes: parameters, quality of service, clocks, credit, a clean end."""
