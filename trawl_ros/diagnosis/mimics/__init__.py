"""Library of mimics: changes of a gear file that an effect may be taken for."""
