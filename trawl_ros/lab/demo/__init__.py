# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""`trawl demo`: tow, record, replay, identification and diagnosis in one command."""
