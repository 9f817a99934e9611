"""Changed gears, and hours of random commands."""
