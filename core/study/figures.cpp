// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/study/figures.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "core/base/error.h"
#include "core/study/joint_view.h"
#include "core/volume_io/volume_io.h"

namespace limber {

namespace {

constexpr glm::ivec2 kSliceSize{480, 360}, kBodySize{480, 420}, kCloseSize{360, 300};
constexpr double kCloseUp_mm = 80;  // height of the region that a close-up shows
constexpr double kWithoutJoint_mm = 400;

struct PosedBody {
  std::shared_ptr<const LabelVolume> volume;
  TissueTable tissues;
};

PosedBody read_posed(const CellResult& cell, Progress& progress) {
  VolumeFile file = read_volume(cell.folder / "posed.nrrd", progress);
  std::optional<TissueTable> user;
  // If one of the input files of this cell (one run of the study) is a tissue table, its entries override those of the
  // volume file.
  for (const auto& [path, hash] : cell.inputs)
    if (const Path table = cell.folder / path; std::filesystem::exists(table) && is_tissue_table(table))
      user = read_tissue_table(table);
  TissueTable tissues = merge_tissue_tables(file.tissues, user ? &*user : nullptr);
  return {std::make_shared<const LabelVolume>(std::move(file.volume)), std::move(tissues)};
}

const JointFigures* furthest_joint(const CellResult& cell) {
  const JointFigures* furthest = nullptr;
  for (const JointFigures& joint : cell.joints)
    if (!furthest || joint.degrees > furthest->degrees) furthest = &joint;
  return furthest;
}

glm::dvec3 middle_of(const Grid& grid) { return world_from_voxel(grid) * (glm::dvec3(grid.size - 1) / 2.0); }

PictureFrame slice_frame(const JointFigures& joint) {
  PictureFrame frame = joint_plane(joint);
  frame.size = kSliceSize;
  return frame;
}

// The bounding rectangle of the tissue in a picture, projected onto the picture's plane, mm from the frame's centre.
struct Box {
  glm::dvec2 low{1e300}, high{-1e300};
  void add(const LabelVolume& volume, const PictureFrame& frame) {
    const AffineTransform to_world = world_from_voxel(volume.grid);
    std::int64_t i = 0;
    glm::ivec3 v;
    for (v.z = 0; v.z < volume.grid.size.z; ++v.z)
      for (v.y = 0; v.y < volume.grid.size.y; ++v.y)
        for (v.x = 0; v.x < volume.grid.size.x; ++v.x, ++i) {
          if (volume.voxels[i] == 0) continue;
          const glm::dvec3 from = to_world * glm::dvec3(v) - frame.centre;
          const glm::dvec2 at(glm::dot(from, frame.right), glm::dot(from, frame.up));
          low = glm::min(low, at), high = glm::max(high, at);
        }
  }
};

// Draws a white scale bar of 50 mm (10 mm in a close-up) at the lower left.
void draw_scale(Picture& picture, const PictureFrame& frame) {
  const double mm = frame.height_mm > 120 ? 50 : 10;
  const int length = static_cast<int>(std::lround(mm * frame.size.y / frame.height_mm));
  for (int y = frame.size.y - 14; y < frame.size.y - 10; ++y)
    for (int x = 12; x < std::min(12 + length, frame.size.x); ++x)
      for (int c = 0; c < 3; ++c) picture.rgb[3 * (std::size_t(y) * frame.size.x + x) + c] = 0xe6;
}
std::string finished(Picture picture, const PictureFrame& frame) {
  draw_scale(picture, frame);
  return png_of(picture);
}

class Maker {
 public:
  Maker(const Study& study, const std::vector<CellResult>& cells, const StartPictures& start, Progress& progress)
      : study_(study),
        progress_(progress) {
    choose(cells);
    start_drawing(start);
  }

  StudyFigures operator()() {
    const int techniques = static_cast<int>(study_.techniques.size());
    for (PictureGrid* grid : {&figures_.bodies, &figures_.slices})
      grid->png.assign(techniques, std::vector<std::string>(figures_.poses.size()));
    for (PictureGrid* grid : {&figures_.ratios, &figures_.overlaps})
      grid->png.assign(techniques, std::vector<std::string>(1));
    int done = 0;
    const auto each = [&](auto&& work) {
      for (const CellResult* cell : shown_) {
        progress_.update("pictures", double(done++) / double(2 * shown_.size()));
        work(*cell);
      }
    };
    each([&](const CellResult& cell) { draw_slices(cell); });
    frame_bodies();
    each([&](const CellResult& cell) { draw_bodies(cell); });
    std::stable_sort(figures_.close_ups.begin(), figures_.close_ups.end(),
                     [](const CloseUp& a, const CloseUp& b) { return a.region.voxels > b.region.voxels; });
    for (auto& [value, tissue] : figures_.overlaps.legend) tissue.colour = dulled(tissue.colour);
    progress_.update("pictures", 1);
    return std::move(figures_);
  }

 private:
  void choose(const std::vector<CellResult>& cells) {
    for (int s = 1; s < std::ssize(study_.spacings); ++s)
      if (study_.spacings[s] &&
          (!study_.spacings[figures_.spacing] || *study_.spacings[s] < *study_.spacings[figures_.spacing]))
        figures_.spacing = s;
    for (int p = 0; p < std::ssize(study_.poses) && p < kShownPoses; ++p) figures_.poses.push_back(p);
    const JointFigures* furthest = nullptr;
    for (const CellResult& cell : cells) {
      if (!cell.done() || cell.cell.spacing != figures_.spacing) continue;
      const JointFigures* joint = furthest_joint(cell);
      if (joint && (!furthest || joint->degrees > furthest->degrees))
        furthest = joint, figures_.largest_pose = cell.cell.pose;
      if (cell.cell.pose < kShownPoses || cell.cell.pose == figures_.largest_pose) shown_.push_back(&cell);
    }
    furthest_ = furthest;
    if (furthest) figures_.joint = furthest->bone;
  }

  void start_drawing(const StartPictures& start) {
    if (!start) {
      figures_.no_bodies = "this program was built without the renderer";
      return;
    }
    try {
      draw_body_ = start();
    } catch (const Error& error) {
      figures_.no_bodies = error.what();
    }
  }

  // Reads a volume and returns it with each voxel's value in the file as its label. read_volume() may number the labels
  // anew, which this function undoes.
  LabelVolume read_values(const Path& path) const {
    VolumeFile file = read_volume(path, progress_);
    std::vector<Label> value_of(65536, 0);
    for (const Tissue& tissue : file.tissues.tissues) value_of[tissue.label] = static_cast<Label>(tissue.file_value);
    for (Label& label : file.volume.voxels) label = value_of[label];
    return std::move(file.volume);
  }

  PictureFrame frame_of_cell(const CellResult& cell, const LabelVolume& volume) const {
    if (const JointFigures* joint = furthest_joint(cell)) return slice_frame(*joint);
    if (furthest_) return slice_frame(*furthest_);
    return {.centre = middle_of(volume.grid), .height_mm = kWithoutJoint_mm, .size = kSliceSize};
  }
  std::ptrdiff_t column_of(const CellResult& cell) const {
    const auto found = std::find(figures_.poses.begin(), figures_.poses.end(), cell.cell.pose);
    return found == figures_.poses.end() ? -1 : found - figures_.poses.begin();
  }

  void draw_slices(const CellResult& cell) {
    const PosedBody body = read_posed(cell, progress_);
    const PictureFrame frame = frame_of_cell(cell, *body.volume);
    const LabelColours colours = tissue_colours(body.tissues);
    const int technique = cell.cell.technique;
    figures_.slices.width_mm = figures_.ratios.width_mm = figures_.overlaps.width_mm =
        frame.height_mm * frame.size.x / frame.size.y;
    if (const auto column = column_of(cell); column >= 0) {
      figures_.slices.png[technique][column] = finished(slice_picture(*body.volume, colours, frame), frame);
      add_shown(*body.volume, body.tissues, frame, ShownPart::Slice, figures_.slices.legend);
    }
    if (!middle_) middle_ = middle_of(body.volume->grid);
    box_.add(*body.volume, body_frame(cell));

    // Results of an editor session may lack the files overlap.nrrd and ratio.nrrd. Their pictures are then left out.
    const bool is_largest = cell.cell.pose == figures_.largest_pose;
    if (const Path overlap = cell.folder / "overlap.nrrd"; is_largest && std::filesystem::exists(overlap)) {
      figures_.overlaps.png[technique][0] =
          finished(marked_picture(*body.volume, read_values(overlap), colours, frame), frame);
      add_shown(*body.volume, body.tissues, frame, ShownPart::Slice, figures_.overlaps.legend);
    }
    if (!std::filesystem::exists(cell.folder / "ratio.nrrd")) return;
    const LabelVolume ratios = read_values(cell.folder / "ratio.nrrd");
    if (is_largest) figures_.ratios.png[technique][0] = finished(slice_picture(ratios, ratio_colours(), frame), frame);
    add_close_up(cell, *body.volume, ratios, colours, frame);
  }

  // Keeps one close-up for each technique: of the pose with the most voxels that are stretched beyond twice, or
  // compressed below half, their volume. Skips mass-exact variants of techniques, since they have the same volume
  // ratios.
  void add_close_up(const CellResult& cell, const LabelVolume& volume, const LabelVolume& ratios,
                    const LabelColours& colours, PictureFrame frame) {
    const Technique& technique = study_.techniques[cell.cell.technique];
    if (technique.mass_exact && std::count(study_.techniques.begin(), study_.techniques.end(), technique.plain()))
      return;
    const auto region = worst_region(ratios);
    if (!region) return;
    const auto same = std::find_if(figures_.close_ups.begin(), figures_.close_ups.end(),
                                   [&](const CloseUp& one) { return one.cell->cell.technique == cell.cell.technique; });
    if (same != figures_.close_ups.end() && same->region.voxels >= region->voxels) return;
    frame.centre = region->centre;
    frame.height_mm = kCloseUp_mm;
    frame.size = kCloseSize;
    CloseUp close{&cell,
                  *region,
                  finished(slice_picture(volume, colours, frame), frame),
                  finished(slice_picture(ratios, ratio_colours(), frame), frame),
                  {}};
    if (same != figures_.close_ups.end()) *same = std::move(close);
    else figures_.close_ups.push_back(std::move(close));
  }

  // Returns the frame for a 3D picture of the cell's body. draw_bodies() sets its final centre and height later, when
  // the size of all bodies is known. All poses of the joint that turns the furthest are seen from one side.
  PictureFrame body_frame(const CellResult& cell) const {
    const JointFigures* joint = furthest_joint(cell);
    if (!joint || (furthest_ && joint->bone == furthest_->bone)) joint = furthest_;
    PictureFrame frame{.centre = *middle_, .height_mm = kWithoutJoint_mm};
    if (joint) frame = folding_view(*joint, *middle_);
    frame.size = kBodySize;
    return frame;
  }

  // Computes one frame size for the 3D pictures of all bodies, so that they have the same scale.
  void frame_bodies() {
    if (box_.low.x > box_.high.x) return;
    const glm::dvec2 extent = box_.high - box_.low;
    constexpr double kMargin = 1.06;
    body_height_ = kMargin * std::max(extent.y, extent.x * kBodySize.y / kBodySize.x);
    body_shift_ = (box_.low + box_.high) / 2.0;
    figures_.bodies.width_mm = body_height_ * kBodySize.x / kBodySize.y;
  }

  void draw_bodies(const CellResult& cell) {
    const auto close = std::find_if(figures_.close_ups.begin(), figures_.close_ups.end(),
                                    [&](const CloseUp& one) { return one.cell == &cell; });
    const auto column = column_of(cell);
    if (close == figures_.close_ups.end() && (column < 0 || !draw_body_)) return;
    const PosedBody body = read_posed(cell, progress_);
    PictureFrame frame = frame_of_cell(cell, *body.volume);
    if (close != figures_.close_ups.end()) {
      PictureFrame near = frame;
      near.centre = close->region.centre;
      near.height_mm = kCloseUp_mm;
      near.size = kCloseSize;
      if (draw_body_) close->body = draw_body_({body.volume, &body.tissues, near, true});
      if (draw_body_) add_shown(*body.volume, body.tissues, near, ShownPart::CutSurface, figures_.close_up_legend);
      add_shown(*body.volume, body.tissues, near, ShownPart::Slice, figures_.close_up_legend);
    }
    if (column < 0 || !draw_body_) return;
    frame = body_frame(cell);
    frame.centre += frame.right * body_shift_.x + frame.up * body_shift_.y;
    frame.height_mm = body_height_;
    figures_.bodies.png[cell.cell.technique][column] = draw_body_({body.volume, &body.tissues, frame, false});
    add_shown(*body.volume, body.tissues, frame, ShownPart::Surface, figures_.bodies.legend);
  }

  const Study& study_;
  Progress& progress_;
  StudyFigures figures_;
  std::vector<const CellResult*> shown_;
  const JointFigures* furthest_ = nullptr;  // the joint that turns the furthest; null: no joint turns
  std::optional<glm::dvec3> middle_;        // middle of the first body's grid, world space, mm
  PictureMaker draw_body_;
  Box box_;
  double body_height_ = 1;
  glm::dvec2 body_shift_{0};
};

}  // namespace

StudyFigures make_figures(const Study& study, const std::vector<CellResult>& cells, const StartPictures& start,
                          Progress& progress) {
  return Maker(study, cells, start, progress)();
}

}  // namespace limber
