"""Inference of a diagnosis: evidence of hypotheses, posterior, and decision."""
