#!/bin/sh
# The command `limber @command@` as a module of 3D Slicer: name this script's folder in Edit > Application Settings > Modules.
exec "$(dirname "$(readlink -f "$0")")/../../../bin/limber" @command@ "$@"
