"""Pictures of the tow in a bag."""
