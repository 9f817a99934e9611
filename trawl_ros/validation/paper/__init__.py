"""Section IV of the founding paper, remade."""
