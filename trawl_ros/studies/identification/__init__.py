"""Study of the identification's accuracy on data from plants that differ from the model."""
