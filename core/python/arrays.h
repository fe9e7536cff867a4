// SPDX-License-Identifier: AGPL-3.0-or-later
// Converts between NumPy arrays and Limber's values. Arrays of voxels are indexed [x, y, z], with x fastest in memory
// (Fortran order), as in nibabel; arrays of SimpleITK must be transposed.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <glm/glm.hpp>

#include "core/base/rigid_transform.h"
#include "core/volume/grid.h"

namespace limber::python {

using Doubles = pybind11::array_t<double, pybind11::array::c_style | pybind11::array::forcecast>;

// Returns a read-only array over the voxels of a grid without copying them. `owner` keeps them alive.
template <class T>
pybind11::array voxel_array(const Grid& grid, const T* voxels, std::shared_ptr<const void> owner) {
  auto* held = new std::shared_ptr<const void>(std::move(owner));
  const pybind11::capsule keeper(held, [](void* kept) { delete static_cast<std::shared_ptr<const void>*>(kept); });
  const auto size = pybind11::ssize_t(sizeof(T));
  pybind11::array_t<T> array(
      {pybind11::ssize_t(grid.size.x), pybind11::ssize_t(grid.size.y), pybind11::ssize_t(grid.size.z)},
      {size, size * grid.size.x, size * grid.size.x * grid.size.y}, voxels, keeper);
  pybind11::detail::array_proxy(array.ptr())->flags &= ~pybind11::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return array;
}

// Returns an owner that keeps a Python object alive and may be released by any thread.
std::shared_ptr<const void> owner_of(pybind11::object object);

// Return an array of 3 or N x 3 numbers.
pybind11::array_t<double> array_of(const glm::dvec3& v);
pybind11::array_t<double> array_of(std::span<const glm::dvec3> points);
// Returns a 3 x 3 array whose columns are those of the matrix.
pybind11::array_t<double> array_of(const glm::dmat3& matrix);
// Returns an N x 4 x 4 array.
pybind11::array_t<double> array_of(std::span<const RigidTransform> transforms);

// Return the values of an array. They throw ValueError, which names the argument, if the array has another shape or a
// number is not finite.
glm::dvec3 vector_from(const Doubles& array, const std::string& name);
glm::dmat3 matrix_from(const Doubles& array, const std::string& name);
std::vector<glm::dvec3> points_from(const Doubles& array, const std::string& name);

}  // namespace limber::python
