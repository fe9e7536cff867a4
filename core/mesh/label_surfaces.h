// SPDX-License-Identifier: AGPL-3.0-or-later
// Builds the surfaces of all tissues of a label volume at once, so that neighbouring tissues share their border: a dual
// surface net over labels [Gibson, Constrained elastic surface nets, MICCAI 1998; Frisken, SurfaceNets for multi-label
// segmentations, JCGT 2022]. Every cube of eight voxel centres that has two or more labels gets one vertex. For every
// pair of neighbouring voxels with different labels, a quad joins the vertices of the four cubes around the pair.
// Smoothing does not shrink the body [Taubin, SIGGRAPH 1995] and keeps each vertex within 0.4 voxel of its cube's
// centre along each axis, so that a layer one voxel thick stays whole. Vertices on a line where three labels meet are
// smoothed along that line only. Tissue that is one or two voxels thick (a nerve, a nail) still loses volume to
// smoothing, and loses more with more steps.
//
// Each tissue's surface is a closed manifold: every edge belongs to exactly two of its triangles, and the triangles
// around a vertex form one fan. Where two voxels of a tissue touch at an edge or a corner only, they are separated:
// the surface has two vertices at one position. Everything beyond the grid counts as air.
#pragma once

#include <vector>

#include "core/base/progress.h"
#include "core/volume/label_volume.h"

namespace limber {

struct LabelSurface {
  Label label = 0;
  std::vector<int> vertex;    // row of LabelSurfaces::V for each vertex; a row may occur more than once
  std::vector<glm::ivec3> F;  // #F triangles (indices into `vertex`), counter-clockwise seen from outside the tissue
  // Returns the Euler number #V - #E + #F; a closed surface has #E = 3 #F / 2 edges.
  int euler_number() const { return static_cast<int>(vertex.size()) - static_cast<int>(F.size()) / 2; }
};

struct LabelSurfaces {
  std::vector<glm::dvec3> V;           // vertex positions, world, mm
  std::vector<LabelSurface> surfaces;  // in ascending order of label
};

struct LabelSurfaceSettings {
  // The number of smoothing steps, each forward and back. With 0 each vertex stays at the centre of its cube, and each
  // surface encloses exactly the volume of its voxels.
  int relaxations = 5;
};

LabelSurfaces label_surfaces(const LabelVolume& volume, const LabelSurfaceSettings& settings = {},
                             Progress& progress = no_progress());

// Returns the volume inside the surface, mm3.
double enclosed_volume(const LabelSurfaces& all, const LabelSurface& surface);

}  // namespace limber
