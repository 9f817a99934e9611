"""Scores of the verdicts on blind trials, and their report."""
