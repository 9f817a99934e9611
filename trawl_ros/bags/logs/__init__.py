"""Logs of others made into bags: tables, and NMEA 0183."""
