"""Effects of ropes, weights, floats and net."""
