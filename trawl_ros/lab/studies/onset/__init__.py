"""The study of effects that begin during a tow: found or not, how soon, and false findings."""
