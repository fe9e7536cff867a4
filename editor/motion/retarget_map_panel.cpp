// SPDX-License-Identifier: AGPL-3.0-or-later
// Dialog of the retarget map. It has a row for each bone of the rig, in which the user selects the joint of the motion
// that moves the bone. Every change acts at once and can be undone.
#include <algorithm>
#include <cstdio>

#include "editor/context/context.h"
#include "editor/context/dialogs.h"
#include "editor/context/operator.h"
#include "editor/context/operator_button.h"
#include "editor/context/panels.h"
#include "editor/dialogs/dialog.h"
#include "editor/motion/motion_clip_edits.h"
#include "editor/motion/timeline.h"
#include "editor/ui/icons.h"
#include "editor/ui/input_fields.h"
#include "editor/ui/messages.h"

namespace limber::editor {

namespace {

const char* words_of(MatchKind kind) {
  switch (kind) {
    case MatchKind::None: return "not moved";
    case MatchKind::ByHand: return "by hand";
    case MatchKind::Chain: return "by position";
    case MatchKind::SamePart: return "body part";
    case MatchKind::SameName: return "same name";
  }
  return "";
}

class MapDialog final : public Dialog {
 public:
  void draw(Context& context) override;

 private:
  void prepare(const ClipOnRig& clip);
  void draw_row(Context& context, Column& column, int bone);
  void match(Context& context, int bone, int choice);

  const Clip* prepared_for_ = nullptr;
  std::shared_ptr<const Armature> armature_;
  RetargetMap map_;
  std::vector<MatchKind> kinds_;
  std::vector<std::string> choices_;  // the choices of each row: "nothing", then the names of the joints
};

// Returns the x coordinates of the left edges of the columns "Moved by" and "Found by", pixels.
std::pair<float, float> columns_of(const Look& look, const Rect& row) {
  return {row.low.x + std::round(row.width() * 0.38f), row.high.x - look.px(130)};
}

void MapDialog::prepare(const ClipOnRig& clip) {
  if (prepared_for_ == clip.clip().get() && armature_ == clip.armature()) return;
  prepared_for_ = clip.clip().get();
  armature_ = clip.armature();
  map_ = map_in_use(clip);
  kinds_ = match_kinds(*clip.clip()->motion, *armature_, map_);
  choices_ = {"nothing"};
  for (const BvhJoint& joint : clip.clip()->motion->joints) choices_.push_back(joint.name);
}

void MapDialog::match(Context& context, int bone, int choice) {
  const std::string name = armature_->bones[bone].name;
  RetargetMap map = map_;
  if (choice == 0) map.sources.erase(name);
  else map.sources[name] = {choices_[choice], {}};
  if (map.sources.empty()) return context.messages->info("Map", "At least one bone must be moved by a joint");
  edit_clip(context, "Match " + name, PoseThen::FromClip, [&](Clip& clip) { clip.map = map; });
}

void MapDialog::draw_row(Context& context, Column& column, int bone) {
  const Look& look = context.ui->look;
  const Rect row = column.row(28);
  if (!ImGui::IsRectVisible(im(row.low), im(row.high))) return;
  if (bone % 2) fill(row, look.theme.row_alt);
  const std::string& name = armature_->bones[bone].name;
  const PathScope path(context.ui, name);
  const auto [joint_left, kind_left] = columns_of(look, row);
  put_text(context.ui, look.fonts.regular, look.theme.text,
           Rect{{row.low.x + look.px(10), row.low.y}, {joint_left - look.px(8), row.high.y}}, name);
  const auto place = std::find(choices_.begin() + 1, choices_.end(), map_.joint_of(name));
  int chosen = place == choices_.end() ? 0 : static_cast<int>(place - choices_.begin());
  if (choice_field(context.ui,
                   {{joint_left, row.low.y + look.px(3)}, {kind_left - look.px(10), row.high.y - look.px(3)}}, choices_,
                   chosen))
    return match(context, bone, chosen);
  const MatchKind kind = kinds_[bone];
  const Colour colour = kind == MatchKind::None       ? look.theme.text3
                        : kind >= MatchKind::SamePart ? look.theme.ok
                                                      : look.theme.warn;
  put_text(context.ui, look.fonts.small, colour, Rect{{kind_left, row.low.y}, {row.high.x - look.px(50), row.high.y}},
           words_of(kind));
  if (kind <= MatchKind::ByHand) return;
  char text[16];
  std::snprintf(text, sizeof text, "%.0f %%", 100 * confidence(kind));
  put_text(context.ui, look.fonts.small_mono, look.theme.text2, Rect{row.low, {row.high.x - look.px(10), row.high.y}},
           text, Align::Right);
}

void MapDialog::draw(Context& context) {
  const Look& look = context.ui->look;
  const ClipOnRig* clip = clip_on_rig(context);
  if (!clip || !clip->clip()->motion) return context.dialogs->close();
  const Rect rect = begin_dialog(context, "Retarget map of " + clip->clip()->name, 600, 520);
  prepare(*clip);
  const float foot = look.px(28), head = look.px(20);
  {
    // The column titles end before the scroll bar, so that they line up with the rows.
    const auto [joint_left, kind_left] = columns_of(look, {rect.low, {rect.high.x - look.px(10), rect.high.y}});
    for (const auto& [left, words] :
         {std::pair{rect.low.x + look.px(10), "Bone"}, {joint_left, "Moved by"}, {kind_left, "Found by"}})
      put_text(context.ui, look.fonts.small, look.theme.text3,
               Rect{{left, rect.low.y - look.px(4)}, {left + look.px(110), rect.low.y + head - look.px(6)}}, words);
    Column column(context.ui, "bones",
                  {{rect.low.x, rect.low.y + head}, {rect.high.x, rect.high.y - foot - look.px(14)}});
    for (int bone = 0; bone < std::ssize(armature_->bones); ++bone) draw_row(context, column, bone);
  }
  const float low = rect.high.y - foot;
  float x = rect.low.x;
  for (const char* id : {"motion.map_by_names", "motion.load_map", "motion.save_map"}) {
    const Operator* op = find_operator(context.operators, id);
    const float width = width_of_button(context.ui, {op->icon, op->label});
    operator_button(context, id, {{x, low}, {x + width, rect.high.y}}, op->label);
    x += width + look.px(8);
  }
  if (button(context.ui, "Done", {{rect.high.x - look.px(96), low}, rect.high}, {"", "Done", ButtonStyle::Primary}))
    context.dialogs->close();
  end_dialog(context);
}

}  // namespace

void open_map(Context& context) { context.dialogs->open(std::make_unique<MapDialog>()); }

}  // namespace limber::editor
