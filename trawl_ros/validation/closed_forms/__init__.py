"""Cases whose answer is known without the model."""
