// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/volume/image_labels.h"

#include "core/base/error.h"
#include "core/prepare/ct_labels.h"
#include "editor/context/arriving_body.h"
#include "editor/context/background_task.h"
#include "editor/context/context.h"
#include "editor/context/dialogs.h"
#include "editor/context/selection.h"
#include "editor/dialogs/form_dialog.h"
#include "editor/shown/frame_all.h"
#include "editor/ui/messages.h"
#include "editor/ui/ui.h"
#include "editor/volume/shown_image.h"
#include "editor/volume/volume_edits.h"

namespace limber::editor {

namespace {

using Fields = std::vector<FormField>;

CtThresholds thresholds_of(const Fields& fields) {
  CtThresholds thresholds;
  thresholds.bone = fields[0].value;
  thresholds.soft = fields[1].value;
  thresholds.fat = fields[2].value;
  thresholds.body = fields[3].value;
  thresholds.skin_mm = fields[4].value;
  return thresholds;
}

// Returns the shown image. Throws Error if it has been closed since the form was opened.
const GreyLevels& image_of(const Context& context) {
  if (!context.views->image) throw Error("the image was closed", "Labels from image", "open the image again");
  return *context.views->image->image;
}

std::string size_and_loss(const Context& context) {
  return size_text(image_of(context).grid.size) + " voxels." +
         (context.document().tissues && !context.document().tissues->tissues.empty()
              ? " The labels, rig and weights of the open body are replaced; undo brings them back."
              : "");
}

std::string outcome(const Context& context, const Fields& fields) {
  const CtThresholds t = thresholds_of(fields);
  if (!(t.body < t.fat && t.fat < t.soft && t.soft < t.bone))
    throw Error("the thresholds must be in ascending order", "body, fat, soft tissue, bone",
                "enter them in ascending order");
  return size_and_loss(context);
}

std::string outcome_of_body(const Context& context, const Fields& fields) {
  const GreyLevels& image = image_of(context);
  if (fields[0].value <= image.least)
    throw Error("every voxel would be body", "Body threshold", "enter a value above the image's smallest value");
  return size_and_loss(context);
}

using MakeLabels = std::function<CtLabels(const GreyLevels&, Progress&)>;

void start_labels(Context& context, const std::string& label, const std::string& advice, MakeLabels make) {
  image_of(context);
  const auto image = context.views->image->image;
  const auto before = context.document().volume;
  const int id =
      context.jobs->start(label,
                          [image, before, label, make = std::move(make),
                           make_ready = body_maker(*context.views)](Progress& progress) -> Edit {
                            CtLabels labels = make(*image, progress);
                            const auto volume = std::make_shared<const LabelVolume>(std::move(labels.volume));
                            const auto tissues = std::make_shared<const TissueTable>(std::move(labels.tissues));
                            make_ready({.volume = volume, .tissues = tissues}, progress, {});
                            return [volume, tissues, before, label](const Document& now) {
                              if (now.volume != before)
                                throw Error("another volume was opened meanwhile", label, "run the command again");
                              Document next;
                              next.volume = volume;
                              next.tissues = tissues;
                              next.volume_type = std::make_shared<const FileType>(FileType{"NRRD", "uint8", true});
                              next.clips = now.clips;
                              next.clip = now.clip;
                              next.frame = now.frame;
                              return next;
                            };
                          });
  context.background->step_of_job[id] = StepOfWork::Prepare;
  context.background->after_job[id] = [label, advice, before](Context& c, const JobStatus& job) {
    if (job.state != JobState::Done) return;
    *c.selection = {};
    c.views->display = render::Display::Solid;
    // The views keep their places where the labels lie on the grid that they have shown before.
    if (!before || !(before->grid == c.document().volume->grid)) frame_all(c, false);
    c.messages->ok(label, std::to_string(c.document().tissues->tissues.size()) + " tissues. " + advice);
  };
  context.ui->touch();
}

}  // namespace

void ask_for_labels(Context& context) {
  const CtThresholds usual;
  const auto field = [](const char* name, const char* description, double value) {
    return number_of(name, description, value, -1024, 3071, "%.0f", "HU");
  };
  context.dialogs->open(make_form(
      {"Labels from CT",
       "Separates tissues by thresholds (Hounsfield units). Leaves out the table and blankets. Bones that touch become "
       "one label.",
       "Make labels",
       {field("Bone threshold", "Voxels of at least this value become bone.", usual.bone),
        field("Tissue threshold", "Voxels of at least this value, but below the bone threshold, become soft tissue.",
              usual.soft),
        field("Fat threshold", "Voxels of at least this value, but below the tissue threshold, become fat.", usual.fat),
        field("Body threshold", "Voxels below this value become air or lung.", usual.body),
        number_of("Skin", "Thickness of the skin. The skin is at least one voxel thick.", usual.skin_mm, 0, 10, "%.1f",
                  "mm")},
       outcome,
       [](Context& c, const Fields& fields) {
         start_labels(c, "Labels from CT", "Look through the slices: contrast agent and metal count as bone.",
                      [thresholds = thresholds_of(fields)](const GreyLevels& image, Progress& progress) {
                        return labels_of_ct(image, thresholds, progress);
                      });
       }}));
}

void ask_for_body(Context& context) {
  const GreyLevels& image = image_of(context);
  context.dialogs->open(make_form(
      {"Labels from MR",
       "Makes labels of body and skin from an image such as an MR, by a threshold. Paint bones afterwards.",
       "Make labels",
       {number_of("Body threshold",
                  "Voxels of at least this value, and all voxels that they enclose in an axial slice, become body. "
                  "Erase air that clasped arms or crossed legs enclose.",
                  body_threshold(image), image.least, image.most(), "%.4g"),
        number_of("Skin", "Thickness of the skin. The skin is at least one voxel thick.", 2, 0, 10, "%.1f", "mm")},
       outcome_of_body,
       [](Context& c, const Fields& fields) {
         start_labels(c, "Labels from MR", "Paint bones with the label brush before a rig is made.",
                      [threshold = fields[0].value, skin = fields[1].value](const GreyLevels& of, Progress& progress) {
                        return labels_of_body(of, threshold, skin, progress);
                      });
       }}));
}

const char* labels_operator(const Views& views) {
  return views.image && looks_like_ct(*views.image->image) ? "image.labels" : "image.body";
}

}  // namespace limber::editor
