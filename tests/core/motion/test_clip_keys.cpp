// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/motion/clip_keys.h"

#include <doctest/doctest.h>

#include "core/motion/constraint.h"

using namespace limber;

TEST_CASE("clip keys: weights play on as before where the last of their keys are deleted or trimmed away") {
  Clip clip{.name = "keys"};
  const Constraint limit{.name = "Limit Spine", .kind = ConstraintKind::LimitRotation, .bone = "Spine"},
      other{.name = "Limit Hips", .kind = ConstraintKind::LimitRotation, .bone = "Hips"};
  clip.constraints = std::make_shared<const Constraints>(Constraints{{limit, other}});
  clip.keys.weights = {{limit.name, {{5, 1}, {15, 0.25}}}, {other.name, {{5, 0.5}, {90, 1}}}};
  Clip deleted = clip;
  delete_clip_keys(deleted, {5, 15});
  CHECK(deleted.constraints->list[0].weight == 0.25);
  CHECK(!deleted.keys.weights.contains(limit.name));
  CHECK(deleted.constraints->list[1].weight == 1);  // unchanged, because one key of this weight is left
  CHECK(deleted.keys.weights.at(other.name) == std::map<int, double>{{90, 1}});
  for (const auto& [low, high] : {std::pair{35, 60}, {10, 30}, {0, 100}, {0, 3}, {95, 99}}) {
    CAPTURE(low);
    Clip trimmed = clip;
    delete_clip_keys_outside(trimmed, low, high);
    for (const int frame : frames_of(trimmed.keys)) CHECK((frame >= low && frame <= high));
    for (std::size_t i = 0; i < 2; ++i)
      for (int frame = low; frame <= high; ++frame)
        CHECK(weight_at(trimmed.constraints->list[i], trimmed.keys, frame) ==
              doctest::Approx(weight_at(clip.constraints->list[i], clip.keys, frame)));
  }
}
