// SPDX-License-Identifier: AGPL-3.0-or-later
// Makes small DICOM files byte by byte, with explicit lengths, little endian.
#pragma once

#include <cstdint>
#include <string>

namespace limber::test {

inline std::string little_endian(std::uint32_t value, int bytes) {
  std::string text;
  for (int i = 0; i < bytes; ++i) text += static_cast<char>(value >> (8 * i) & 255);
  return text;
}

inline std::string dicom_element(std::uint16_t group, std::uint16_t number, const std::string& representation,
                                 std::string value) {
  if (value.size() % 2) value += representation == "UI" ? '\0' : ' ';
  return little_endian(group, 2) + little_endian(number, 2) + representation +
         little_endian(static_cast<std::uint32_t>(value.size()), 2) + value;
}

// Returns the bytes of a DICOM file that precede the elements of its image.
inline std::string dicom_start() {
  const std::string syntax = dicom_element(2, 0x10, "UI", "1.2.840.10008.1.2.1");
  return std::string(128, '\0') + "DICM" +
         dicom_element(2, 0, "UL", little_endian(static_cast<std::uint32_t>(syntax.size()), 4)) + syntax +
         dicom_element(8, 0x16, "UI", "1.2.840.10008.5.1.4.1.1.2");
}

// Returns a DICOM image of 2 by 2 voxels with the values 1 to 4, which a reader must multiply by `slope`.
inline std::string dicom_image(const std::string& slope, const std::string& spacing = "1\\1",
                               const std::string& height = "0") {
  const auto number = [](std::uint32_t value) { return little_endian(value, 2); };
  std::string bytes = dicom_start() + dicom_element(0x18, 0x50, "DS", "1") +
                      dicom_element(0x20, 0x32, "DS", "0\\0\\" + height) + dicom_element(0x28, 2, "US", number(1)) +
                      dicom_element(0x28, 4, "CS", "MONOCHROME2") + dicom_element(0x28, 0x10, "US", number(2)) +
                      dicom_element(0x28, 0x11, "US", number(2)) + dicom_element(0x28, 0x30, "DS", spacing) +
                      dicom_element(0x28, 0x100, "US", number(16)) + dicom_element(0x28, 0x101, "US", number(16)) +
                      dicom_element(0x28, 0x102, "US", number(15)) + dicom_element(0x28, 0x103, "US", number(0)) +
                      dicom_element(0x28, 0x1052, "DS", "0") + dicom_element(0x28, 0x1053, "DS", slope);
  return bytes + little_endian(0x7fe0, 2) + little_endian(0x10, 2) + "OW" + little_endian(0, 2) + little_endian(8, 4) +
         std::string("\1\0\2\0\3\0\4\0", 8);
}

}  // namespace limber::test
