// SPDX-License-Identifier: AGPL-3.0-or-later
// The program limber_reader, which parses volumes for Limber in a process without rights (volume_reader.h). Users do
// not start it themselves.
#include "core/volume_io/serve_volume.h"

int main(int argc, char** argv) { return limber::serve_volume(argc, argv); }
