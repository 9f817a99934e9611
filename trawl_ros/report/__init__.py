"""The kit of reports: templates, and the style of figures."""
