"""Common parts of reports: templates, pictures, and the style of figures."""
