// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume_io/dicom.h"

#include <fstream>

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "tests/support/program.h"

using namespace limber;

TEST_CASE("dicom: a file with the mark and little behind it, on which the library gives up, is refused") {
  const test::TemporaryFolder folder;
  for (const std::string& rest :
       {std::string("001"), std::string(), std::string(64, '\0'), std::string("\x02\0\0\0UL\x04\0", 8)}) {
    std::ofstream(folder / "a.dcm", std::ios::binary) << std::string(128, '\f') << "DICM" << rest;
    REQUIRE(is_dicom_file(folder / "a.dcm"));
    CHECK_THROWS_AS(open_volume(folder / "a.dcm"), Error);
  }
}
