"""What commands share at the terminal: progress, interruption, tables and lazy loading."""
