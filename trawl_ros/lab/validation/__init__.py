"""Checks of the model's claims: closed forms, convergence, the paper, peers, branches."""
