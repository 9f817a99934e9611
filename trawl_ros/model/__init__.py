"""The paper's equations: water, lines, boards, kite and netting, and their assembly."""
