# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Reference codes that the model is compared with, and the wire for the comparison.

`moordyn` and `moorpy` are not needed to use this package and are imported only when asked for;
the extra ``peers`` installs them.
"""
