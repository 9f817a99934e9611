"""Motion in time with its derivatives by parameters, step by step."""
