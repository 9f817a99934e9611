"""Emulates the instruments of a mid-water trawler and keeps the model of its gear honest."""

import os

# On matrices as sparse and small as a gear's, threads of BLAS only wait for one another: on a
# busy machine a check of stability takes ten times as long with them. This has an effect
# where numpy has not been imported before.
os.environ.setdefault('OPENBLAS_NUM_THREADS', '1')

__version__ = '0.1.0'
