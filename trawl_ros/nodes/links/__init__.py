"""Links for sentences: serial ports, pseudo-terminals, UDP and TCP, kept by threads."""
