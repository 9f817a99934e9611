# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Links: serial ports, pseudo-terminals, UDP and TCP for sentences, a WebSocket for viewers."""
