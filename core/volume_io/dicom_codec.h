// SPDX-License-Identifier: AGPL-3.0-or-later
// The interface through which dicom.cpp uses GDCM: C functions in a shared library of their own. When GDCM is loaded,
// it builds a dictionary of every DICOM tag, which takes 15 ms. So the library is loaded only when a DICOM image is
// read. The functions read files by a callback, so that the library needs nothing of Limber.
#pragma once

#include <cstddef>
#include <cstdint>

extern "C" {
// An open file. read_at() reads `size` bytes from `offset` on into `to` and returns how many were read: fewer only at
// the file's end.
struct LimberDicomFile {
  const void* context;
  std::int64_t size;  // size of the file, bytes
  std::size_t (*read_at)(const void* context, std::int64_t offset, char* to, std::size_t size);
};

// Callback that receives `size` bytes, the value of one data element, and the `context` given to
// limber_dicom_elements(). The bytes are valid only during the call.
using LimberDicomElement = void (*)(void* context, std::uint16_t group, std::uint16_t element, const char* bytes,
                                    std::size_t size);

// Calls `visit` with `context` for each data element that has a value and comes before the pixels. Returns 0, or 1 for
// a damaged file.
int limber_dicom_elements(const LimberDicomFile* file, LimberDicomElement visit, void* context);

// Decodes the pixels of a file with one frame into `pixels`. Returns 0 on success, and 1 when the pixels are missing,
// damaged or not exactly `size` bytes.
int limber_dicom_pixels(const LimberDicomFile* file, char* pixels, std::size_t size);
}
