#!/usr/bin/env bash
# Run once by Gradescope, as root, when the autograder is built.
set -e
apt-get update
apt-get install -y --no-install-recommends python3 bubblewrap
chmod 755 /autograder/source/wildfire
# Fails here, and not with the first submission, if the program does not run on this image.
/autograder/source/wildfire --version
