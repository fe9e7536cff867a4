// SPDX-License-Identifier: AGPL-3.0-or-later
// Makes the document that the benchmarks of the editor's frames open: the arm of the Bender project from the folder
// that the environment variable LIMBER_SHARED names, else the procedural arm, with geodesic weights.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <utility>

#include "core/base/file.h"
#include "core/binding/geodesic.h"
#include "core/bones/bone_parts.h"
#include "core/phantom/phantom.h"
#include "core/project/document.h"
#include "core/rig_io/rig_io.h"
#include "core/volume_io/volume_io.h"

namespace limber::bench {

inline Document arm_document() {
  LabelVolume volume;
  TissueTable tissues;
  Armature armature;
  const char* shared = std::getenv("LIMBER_SHARED");
  const Path folder = Path(shared ? shared : "") / "data/bender";
  if (shared && std::filesystem::exists(folder / "man-arm-2mm.mha")) {
    VolumeFile file = read_volume(folder / "man-arm-2mm.mha");
    volume = std::move(file.volume), tissues = std::move(file.tissues);
    armature = read_armature(folder / "man-arm-2mm-armature.vtk");
  } else {
    std::fprintf(stderr, "without LIMBER_SHARED: the procedural arm\n");
    Phantom phantom = make_arm_phantom(2);
    volume = std::move(phantom.volume), tissues = std::move(phantom.tissues), armature = std::move(phantom.armature);
  }
  const TissueVoxels tissue(volume);
  Document document;
  document.weights = std::make_shared<const SkinWeights>(
      bind_geodesic(volume, tissue, armature, split_bones(volume, tissue, tissues, armature)));
  document.volume = std::make_shared<const LabelVolume>(std::move(volume));
  document.tissues = std::make_shared<const TissueTable>(std::move(tissues));
  document.volume_type = std::make_shared<FileType>();
  document.armature = std::make_shared<const Armature>(std::move(armature));
  return document;
}

}  // namespace limber::bench
