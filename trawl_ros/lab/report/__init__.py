"""Records and pages shared by validation, benchmark and studies."""
