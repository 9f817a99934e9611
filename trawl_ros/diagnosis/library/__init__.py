"""Library of hypotheses: effects, changes of the gear file and errors of instruments."""
