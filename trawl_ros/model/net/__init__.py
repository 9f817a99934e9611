"""The net as nodes and bars: rows of meshes, the mouth, and its netting."""
