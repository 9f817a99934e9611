"""The report of an identification: JSON, tables, figures, page."""
