// SPDX-License-Identifier: AGPL-3.0-or-later
// The description of a picture as a value. The editor and the command line fill a Scene for each picture, and the
// passes draw it. The scene shares its data with the document by pointers. Data that have the same pointer as in the
// last picture are not uploaded again.
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
struct GreyLevels;
class SkinWeights;
class TissueVoxels;
struct PreviewMap;
}  // namespace limber

namespace limber::render {

enum class Display {
  Solid,   // the outermost visible tissue, opaque
  XRay,    // skin and flesh as a transparent ghost (denser where seen at a slant), with solid bone inside
  Tissue,  // every visible tissue with its own opacity, blended from front to back
  Image,   // the grey image instead of the tissues, rendered as ShownGrey::rendering says
};

// How the 3D view renders a grey image: which values are visible, and in which colours (render/scene/grey_transfer.h).
// Bone, Muscle and Skin are for CT, whose values are Hounsfield units. Window and Maximum use the level and width of
// ShownGrey.
enum class GreyRendering { Bone, Muscle, Skin, Window, Maximum };

// A grey image (CT, MR). Slices show it below the tissues; with Display::Image, the 3D view shows it. The image moves
// with a posed body, as the labels do. Where the posed body has no tissue, the image is not shown.
struct ShownGrey {
  std::shared_ptr<const GreyLevels> image;
  // The value that slices show as middle grey, and the difference between the values shown as white and as black.
  double level = 40, width = 400;
  float tissues = 0.35f;  // opacity of tissues and weights over the image in slices, [0, 1]
  GreyRendering rendering = GreyRendering::Bone;

  bool operator==(const ShownGrey&) const = default;
};

// The appearance of a label.
struct LabelLook {
  glm::vec3 colour{0.7f};  // colour of the label, sRGB
  float opacity = 1;
  bool visible = true;
  bool bone = false;  // true: the label stays solid in X-ray

  bool operator==(const LabelLook&) const = default;
};
using LabelLooks = std::vector<LabelLook>;  // one look for each label; labels beyond the end are invisible

struct BoneLook {
  bool selected = false, active = false, hovered = false;
};
enum class BoneShape { Octahedron, Stick, Cylinder, None };

// A bone under a pixel.
struct BoneHit {
  int bone;
  // Distance of the pixel from the bone's axis, as a fraction [0, 1) of the largest distance that counts as a hit.
  double off;
  double depth;  // depth of the axis at the pixel, mm from the eye along the viewing direction
};

// A box and a plane that cut the volume open. The cut faces show the tissues without shading.
struct Clip {
  // Low and high corner of the clip box in the volume's voxel coordinates.
  std::optional<std::array<glm::dvec3, 2>> box;
  // A point and the unit normal of the plane, world, mm. The side to which the normal points is hidden.
  std::optional<std::array<glm::dvec3, 2>> plane;
};

// What the colours show when skin weights are shown instead of tissues (render/scene/weight_colormap.h).
enum class WeightDisplay {
  Active,    // the weight of the active bone; weights of exactly 0 and exactly 1 have special colours
  Dominant,  // the bone with the largest weight
  Mixed,     // all bones of the voxel, with their colours mixed by weight
  Count,     // the number of bones that have weight in the voxel
  Field,     // a given colour for each voxel (ShownWeights::field) instead of weights, for any measured quantity
};
struct ShownWeights {
  std::shared_ptr<const SkinWeights> weights;  // the weights to show; null for WeightDisplay::Field
  std::shared_ptr<const TissueVoxels> tissue;  // the tissue voxels of the volume
  WeightDisplay display = WeightDisplay::Active;
  int bone = -1;  // the active bone, an index in the weights' bones; -1: no bone is active
  std::shared_ptr<const std::vector<glm::vec3>> swatches;  // colour of each bone of the weights, sRGB
  // One byte for each voxel of `tissue`. Voxels with 0 have dimmed colours. Null: no colours are dimmed.
  std::shared_ptr<const std::vector<std::uint8_t>> region;
  // Colour of each voxel of `tissue`, sRGB; given only for WeightDisplay::Field.
  std::shared_ptr<const std::vector<glm::u8vec3>> field = nullptr;
  // True: lines are drawn on the colours. For Active the lines mark weights of a quarter, a half and three quarters.
  // For other displays they are borders between different colours.
  bool contours = true;

  bool operator==(const ShownWeights&) const = default;
};

// A tet mesh, drawn as lines where a clip plane, the clip box or a slice cuts it.
struct CutMesh {
  std::shared_ptr<const Eigen::MatrixX3i> faces;  // faces of all tets, each once
  std::shared_ptr<const Eigen::MatrixX3d> V;      // node positions, world, mm

  bool operator==(const CutMesh&) const = default;
};

struct Scene {
  std::shared_ptr<const LabelVolume> volume;
  // Inverse map of the posed body, from posed to rest positions. Null: the volume is drawn at rest.
  std::shared_ptr<const PreviewMap> pose;
  std::shared_ptr<const LabelLooks> looks;
  Display display = Display::Solid;
  Clip clip;
  std::optional<ShownWeights> weights;  // how weights are shown; empty: tissue colours are shown
  std::optional<Label> outlined;        // the tissue that has a selection outline
  std::optional<CutMesh> mesh;
  std::optional<ShownGrey> grey;  // the grey image; shown only together with a volume, which may be all air

  std::shared_ptr<const Armature> armature;
  std::vector<RigidTransform> posed_from_rest;  // rest-to-posed transform of each bone; empty: the rig is at rest
  std::vector<BoneLook> bones;                  // appearance of each bone; empty: no bone is selected
  BoneShape bone_shape = BoneShape::Octahedron;
  bool bones_in_front = false;  // true: bones are drawn over the body
  float line_scale = 1;         // factor on line widths and joint radii, for pictures of high resolution

  bool grid = true;             // true: the ground grid is drawn
  bool dark_background = true;  // true: the background gradient of the dark theme; false: that of the light theme
  bool transparent_background = false;  // true: no background is drawn, for saved pictures
};

}  // namespace limber::render
