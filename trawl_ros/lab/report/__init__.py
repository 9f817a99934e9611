"""Records and pages that validation, benchmark and studies share."""
