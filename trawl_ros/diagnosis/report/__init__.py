"""The report of a diagnosis: JSON, sentences, figures, page."""
