"""Library of mimics: changes of gear file or instruments that an effect may be taken for."""
