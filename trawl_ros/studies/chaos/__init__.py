"""The graph under faults: nodes stopped and killed, strangers, full disks, wild clocks."""
