"""Import of foreign logs as bags: tables, and NMEA 0183."""
