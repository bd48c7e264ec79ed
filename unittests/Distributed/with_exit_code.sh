#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Runs a command and says with what it ended, for tests that look at both.
"$@"
echo "exit code $?"
