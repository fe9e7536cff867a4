// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/rig_io/obj_summary.h"

#include <doctest/doctest.h>

#include "core/base/error.h"

using namespace limber;

TEST_CASE("obj: vertices, faces and groups are counted, however corners are written") {
  const ObjSummary obj = parse_obj_summary(
      "# a square\r\no square\nv 0 0 0\nv 1 0 -2.5e1\n\tv 1 1 0 1.0\nv 0 1 0\nvn 0 0 1\nf 1/1/1 2//1 3\nf -1 -2 -4 1\n",
      "test");
  CHECK(obj.vertices == 4);
  CHECK(obj.faces == 2);
  CHECK(obj.groups == 1);
  CHECK(obj.lower == glm::dvec3(0, 0, -25));
  CHECK(obj.upper == glm::dvec3(1, 1, 0));
}

TEST_CASE("obj: corners that are no vertices and numbers that are none are refused") {
  for (const char* text : {"", "f 1 2 3", "v 0 0\n", "v 0 0 nan\n", "v 0 0 0\nf 1 1 2\n", "v 0 0 0\nf 1 1\n",
                           "v 0 0 0\nf 1 1 0\n", "v 0 0 0\nf -2 1 1\n"})
    CHECK_THROWS_AS(parse_obj_summary(text, "test"), Error);
}
