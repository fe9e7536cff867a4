// SPDX-License-Identifier: AGPL-3.0-or-later
// The surfaces of all tissues of a label volume at once, so that neighbours share their border: a dual surface net over
// labels [Gibson, Constrained elastic surface nets, MICCAI 1998; Frisken, SurfaceNets for multi-label segmentations,
// JCGT 2022]. Every cube of eight voxel centres with two labels or more has one vertex; around every pair of
// neighbouring voxels with two labels lies a quad of four of them. Vertices are smoothed without shrinking the body
// [Taubin, SIGGRAPH 1995] and stay within 0.4 voxel of their cube's middle, so that a layer one voxel thick stays
// whole; where three labels meet they follow that line only. What is one or two voxels thick all around (a nerve, a
// nail) loses volume to smoothing all the same, the more the more steps it gets.
//
// Each tissue's surface is a closed manifold: every edge belongs to exactly two of its triangles, and the triangles
// around a vertex are one fan. Where two voxels of a tissue touch by an edge or a corner alone, they are taken apart:
// the surface has the vertices there twice, at one place. Beyond the grid is air.
#pragma once

#include <vector>

#include "core/base/progress.h"
#include "core/volume/label_volume.h"

namespace limber {

struct LabelSurface {
  Label label = 0;
  std::vector<int> vertex;    // #v, which of LabelSurfaces::V each is; one may stand there more than once
  std::vector<glm::ivec3> F;  // #F corners, of `vertex`, counter-clockwise seen from outside of the tissue
  int euler_number() const {
    return static_cast<int>(vertex.size()) - static_cast<int>(F.size()) / 2;
  }  // V - E + F, E = 3 F / 2
};

struct LabelSurfaces {
  std::vector<glm::dvec3> V;           // world, mm
  std::vector<LabelSurface> surfaces;  // by label
};

struct LabelSurfaceSettings {
  int relaxations =
      5;  // steps of smoothing, there and back; 0: vertices in the middle of their cubes, volumes exactly the voxels'
};

LabelSurfaces label_surfaces(const LabelVolume& volume, const LabelSurfaceSettings& settings = {},
                             Progress& progress = no_progress());

double enclosed_volume(const LabelSurfaces& all, const LabelSurface& surface);  // mm3

}  // namespace limber
