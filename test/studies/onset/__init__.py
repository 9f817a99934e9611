"""Effects that begin during a tow: how often and how soon they are found."""
