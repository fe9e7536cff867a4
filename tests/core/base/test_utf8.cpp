// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/base/utf8.h"

#include <doctest/doctest.h>

using namespace limber;

TEST_CASE("utf8: valid text stays as it is, and each byte of anything else becomes the replacement character") {
  for (const char* text : {"", "bone", "Gr\u00f6\u00dfe", "\u9aa8", "\U0001F9B4", "\u007f\u0080\uffff"})
    CHECK(valid_utf8(text) == text);
  CHECK(valid_utf8("Gr\xf6") == "Gr\ufffd");                            // a letter of Latin-1, not valid in UTF-8
  CHECK(valid_utf8("\xc3") == "\ufffd");                                // the second byte is missing
  CHECK(valid_utf8("\xe9\xaa-") == "\ufffd\ufffd-");                    // the third byte is missing; the text goes on
  CHECK(valid_utf8("\xc0\xaf") == "\ufffd\ufffd");                      // "/" in two bytes where one is enough
  CHECK(valid_utf8("\xed\xa0\x80") == "\ufffd\ufffd\ufffd");            // half of a surrogate pair
  CHECK(valid_utf8("\xf4\x90\x80\x80") == "\ufffd\ufffd\ufffd\ufffd");  // above U+10FFFF
}
