"""What a bag says of a tow, as pictures."""
