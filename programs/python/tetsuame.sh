#!/bin/sh
# `tetsuame` of an installation: the package lies in lib/tetsuame/python beside bin.
here=$(dirname "$(readlink -f "$0")")
PYTHONPATH=$here/../lib/tetsuame/python${PYTHONPATH:+:$PYTHONPATH} exec "${PYTHON:-python3}" -m tetsuame "$@"
