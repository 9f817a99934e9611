"""Foundations: errors, limits, checked files, packaged resources, time, parallel tasks."""
