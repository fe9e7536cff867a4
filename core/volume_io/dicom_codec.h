// SPDX-License-Identifier: AGPL-3.0-or-later
// What dicom.cpp needs of GDCM, as plain functions. GDCM fills a dictionary of every DICOM tag when it is loaded, which
// costs 15 ms; as a module of its own it is loaded only when a DICOM image is met. It reads files that are open
// already.
#pragma once

#include <cstddef>
#include <cstdint>

extern "C" {
// Text or bytes of one element, valid during the call.
using LimberDicomElement = void (*)(void* context, std::uint16_t group, std::uint16_t element, const char* bytes,
                                    std::size_t size);

// Calls `visit` for each element of the data set before the pixels that has a value. Returns 0, or 1 for a damaged
// file.
int limber_dicom_elements(int descriptor, LimberDicomElement visit, void* context);

// Decodes the pixels of a file with one frame into `pixels`. Returns 0, or 1 when they are missing, damaged, or not of
// exactly `size` bytes.
int limber_dicom_pixels(int descriptor, char* pixels, std::size_t size);
}
