// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/pose/flex_request.h"

#include <doctest/doctest.h>

#include "core/base/error.h"

namespace limber {

TEST_CASE("flex request: a bone and an angle are read, by the last equals sign") {
  for (const auto& [text, bone, degrees] :
       {std::tuple{"Forearm=45", "Forearm", 45.0}, {"Shin=-360", "Shin", -360.0}, {"a=b=+7.5", "a=b", 7.5}}) {
    CAPTURE(text);
    const FlexRequest request = parse_flex_request(text, "--flex");
    CHECK(request.bone == bone);
    CHECK(request.degrees == degrees);
  }
}

TEST_CASE("flex request: what is no angle of a hinge is refused") {
  for (const char* text : {"", "Forearm", "=45", "Forearm=", "Forearm=x", "Forearm=4 5", "Forearm=nan", "Forearm=-inf",
                           "Forearm=1e999", "Forearm=1e308", "Forearm=360.5"}) {
    CAPTURE(text);
    CHECK_THROWS_WITH_AS(parse_flex_request(text, "here"), doctest::Contains("here"), Error);
  }
}

}  // namespace limber
