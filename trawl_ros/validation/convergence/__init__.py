"""How the answers settle as time and gear are cut finer."""
