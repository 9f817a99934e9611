"""Estimation from all of a tow: stretches in motion, towed with derivatives."""
