// SPDX-License-Identifier: AGPL-3.0-or-later
// The interface through which dicom.cpp uses GDCM: C functions in a shared library of their own. When GDCM is loaded,
// it builds a dictionary of every DICOM tag, which takes 15 ms. So the library is loaded only when a DICOM image is
// read. The functions take descriptors of open files.
#pragma once

#include <cstddef>
#include <cstdint>

extern "C" {
// Callback that receives the bytes of one data element. They are valid only during the call.
using LimberDicomElement = void (*)(void* context, std::uint16_t group, std::uint16_t element, const char* bytes,
                                    std::size_t size);

// Calls `visit` for each data element that has a value and comes before the pixels. Returns 0, or 1 for a damaged file.
int limber_dicom_elements(int descriptor, LimberDicomElement visit, void* context);

// Decodes the pixels of a file with one frame into `pixels`. Returns 0 on success, and 1 when the pixels are missing,
// damaged or not exactly `size` bytes.
int limber_dicom_pixels(int descriptor, char* pixels, std::size_t size);
}
