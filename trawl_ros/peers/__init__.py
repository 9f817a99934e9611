"""Other programs that the model is held against, and the wire on which they all agree to meet.

`moordyn` and `moorpy` are not needed to use this package and are imported only when asked for;
the extra ``peers`` installs them.
"""
