"""Effects of the boards: their law, their rigging, their damage."""
