"""Links: serial ports, pseudo-terminals, UDP and TCP for sentences, a WebSocket for viewers."""
