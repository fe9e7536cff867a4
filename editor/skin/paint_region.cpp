// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/skin/paint_region.h"

#include <algorithm>
#include <numeric>

#include "editor/context/background_task.h"
#include "editor/context/context.h"
#include "editor/skin/painting.h"
#include "editor/skin/weight_display.h"
#include "editor/skin/weight_edits.h"
#include "editor/ui/messages.h"
#include "editor/ui/ui.h"
#include "editor/volume/volume_edits.h"

namespace limber::editor {

namespace {

std::int64_t count(const TissueRegion& region) {
  return std::accumulate(region.begin(), region.end(), std::int64_t{0},
                         [](std::int64_t sum, std::uint8_t one) { return sum + (one != 0); });
}

TissueRegion together(const TissueRegion* old, TissueRegion made, RegionChange change) {
  if (change == RegionChange::Replace) return made;
  for (std::size_t i = 0; i < made.size(); ++i) {
    // If there is no old region, Add starts from an empty region. Subtract and intersect start from all voxels.
    const bool before = old ? (*old)[i] != 0 : change != RegionChange::Add;
    made[i] = change == RegionChange::Add       ? before || made[i]
              : change == RegionChange::TakeOut ? before && !made[i]
                                                : before && made[i];
  }
  return made;
}

}  // namespace

void change_region(Context& context, const std::string& label, RegionChange change, const WhereOfRegion& where) {
  const WeightsToEdit what = weights_to_edit(context);
  const auto old = painted_region(context);
  const auto make = [=] { return together(old.get(), where(what), change); };
  const auto keep = [volume = what.document.volume, label](Context& c, TissueRegion made) {
    const std::int64_t voxels = count(made);
    if (c.document().volume != volume) return;
    if (voxels == 0) return c.messages->warn(label, "No tissue lies in this region: the old region stays");
    c.skin->painting->region = {volume, std::make_shared<const TissueRegion>(std::move(made)), voxels};
    c.messages->info(label, grouped(voxels) + " voxels can be changed by brushes and edits");
    c.ui->touch();
  };
  if (what.tissue->size() <= context.skin->painting->edited_at_once) return keep(context, make());
  start_task(context, label, [make, keep](Progress& progress) -> Finish {
    progress.update("where", 0);
    auto made = std::make_shared<TissueRegion>(make());
    return [made, keep](Context& c) { keep(c, std::move(*made)); };
  });
}

void clear_region(Context& context) {
  context.skin->painting->region = {};
  context.ui->touch();
}

}  // namespace limber::editor
