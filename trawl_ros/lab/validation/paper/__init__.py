"""Reproduction of section IV of the founding paper."""
