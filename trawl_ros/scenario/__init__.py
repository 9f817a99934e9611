"""Scenario files: commands of ship and winches, gear, water and instruments of a trial."""
