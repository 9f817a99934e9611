"""What identification is worth: data from plants that are not the model, and what comes of them."""
