"""The study of hostile messages to every subscription of every node."""
