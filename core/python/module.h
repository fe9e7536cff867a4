// SPDX-License-Identifier: AGPL-3.0-or-later
// The Python module `limber._limber`. Each function adds the classes and functions of one subject to the module. The
// docstrings are the reference for users of Python; limber/__init__.pyi declares the types.
#pragma once

#include <memory>

#include <pybind11/pybind11.h>

#include "core/body/bind_body.h"
#include "core/body/body.h"
#include "core/motion/bvh.h"
#include "core/phantom/phantom.h"

namespace limber::python {

// A label volume with its tissues. It never changes, so its voxels can be shared instead of copied.
struct Volume {
  std::shared_ptr<const VolumeFile> file;
};
// Returns a VolumeFile that shares the voxels of `volume`.
VolumeFile shared_copy(const Volume& volume);
Volume volume_of(VolumeFile file);

// A body whose weights were computed or read.
struct Weights {
  std::shared_ptr<const Body> body;
  std::shared_ptr<BoundBody> bound;
};

void add_volumes(pybind11::module_& module);
void add_rigs(pybind11::module_& module);
void add_motions(pybind11::module_& module);
void add_bodies(pybind11::module_& module);
void add_previews(pybind11::module_& module);

}  // namespace limber::python
