// SPDX-License-Identifier: AGPL-3.0-or-later
// What is to be drawn, as a value: the editor and the command line fill one for each picture, the passes draw it. Parts
// are shared with the document; equal pointers mean that nothing needs to be uploaded again.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <glm/glm.hpp>

#include "core/base/rigid_transform.h"
#include "core/rig/armature.h"
#include "core/volume/label_volume.h"

namespace limber {
class SkinWeights;
class TissueVoxels;
struct PreviewMap;
}  // namespace limber

namespace limber::render {

enum class Display {
  Solid,   // the outermost visible tissue, opaque
  XRay,    // skin and flesh as a ghost (fresnel), bone solid inside
  Tissue,  // every visible tissue with its own opacity, front to back
};

// How a label is drawn.
struct LabelLook {
  glm::vec3 colour{0.7f};  // sRGB
  float opacity = 1;
  bool visible = true;
  bool bone = false;  // stays solid in X-ray

  bool operator==(const LabelLook&) const = default;
};
using LabelLooks = std::vector<LabelLook>;  // by label; beyond its end: invisible

struct BoneLook {
  bool selected = false, active = false, hovered = false;
};
enum class BoneShape { Octahedron, Stick, Cylinder, None };

// A bone under a pixel.
struct BoneHit {
  int bone;
  double off;    // how far beside it the pixel is, of 1 where the bone is no longer meant
  double depth;  // of its middle line there, mm before the eye along the direction of view
};

// Half-spaces and a box that cut the volume open; a cut face shows the tissues unshaded.
struct Clip {
  std::optional<std::array<glm::dvec3, 2>> box;    // low, high corner in voxel coordinates of the volume
  std::optional<std::array<glm::dvec3, 2>> plane;  // point and unit normal, world; hidden is the normal's side
};

// What of skin weights is shown in the tissues' place (render/scene/weight_colormap.h).
enum class WeightDisplay {
  Active,    // the weight of one bone, exact 0 and exact 1 apart
  Dominant,  // the bone that has most of a voxel
  Mixed,     // all its bones, by their shares
  Count,     // how many bones it follows
  Field,     // no weights: a colour of its own for each voxel, of whatever is measured there
};
struct ShownWeights {
  std::shared_ptr<const SkinWeights> weights;  // null of a field
  std::shared_ptr<const TissueVoxels> tissue;  // of the volume
  WeightDisplay display = WeightDisplay::Active;
  int bone = -1;                                           // of the weights' bones, the active one; -1: none
  std::shared_ptr<const std::vector<glm::vec3>> swatches;  // #bones of the weights, sRGB
  std::shared_ptr<const std::vector<std::uint8_t>>
      region;  // a byte per voxel of `tissue`: where it is 0 colours are dull; null: none are
  std::shared_ptr<const std::vector<glm::u8vec3>> field = nullptr;  // #voxels of `tissue`, sRGB; of a field alone
  bool contours =
      true;  // lines where the active bone's weight passes a quarter, a half, three quarters; else between colours

  bool operator==(const ShownWeights&) const = default;
};

// A tet mesh that is shown by lines where the clip or a slice cuts it.
struct CutMesh {
  std::shared_ptr<const Eigen::MatrixX3i> faces;  // each once
  std::shared_ptr<const Eigen::MatrixX3d> V;      // where its nodes are, world, mm

  bool operator==(const CutMesh&) const = default;
};

struct Scene {
  std::shared_ptr<const LabelVolume> volume;
  std::shared_ptr<const PreviewMap> pose;  // of this volume: its body is drawn as the map leads; null: as the volume is
  std::shared_ptr<const LabelLooks> looks;
  Display display = Display::Solid;
  Clip clip;
  std::optional<ShownWeights> weights;  // nothing: tissues
  std::optional<Label> outlined;        // tissue with a selection outline
  std::optional<CutMesh> mesh;

  std::shared_ptr<const Armature> armature;
  std::vector<RigidTransform> posed_from_rest;  // #bones; empty: at rest
  std::vector<BoneLook> bones;                  // #bones; empty: none selected
  BoneShape bone_shape = BoneShape::Octahedron;
  bool bones_in_front = false;  // X-ray: drawn on top
  float line_scale = 1;         // the picture's pixels for one of a line's width or a joint's radius

  bool grid = true;                     // ground grid
  bool dark_background = true;          // the dark theme's gradient, else the light theme's
  bool transparent_background = false;  // for pictures
};

}  // namespace limber::render
