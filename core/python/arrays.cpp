// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/python/arrays.h"

#include <algorithm>
#include <cmath>

namespace py = pybind11;

namespace limber::python {

namespace {
void check_finite(const Doubles& array, const std::string& name) {
  if (!std::all_of(array.data(), array.data() + array.size(), [](double value) { return std::isfinite(value); }))
    throw py::value_error(name + ": every number must be finite");
}
}  // namespace

std::shared_ptr<const void> owner_of(py::object object) {
  return {object.release().ptr(), [](PyObject* kept) {
            const py::gil_scoped_acquire with_lock;
            Py_DECREF(kept);
          }};
}

py::array_t<double> array_of(const glm::dvec3& v) {
  py::array_t<double> array(3);
  for (int i = 0; i < 3; ++i) array.mutable_at(i) = v[i];
  return array;
}

py::array_t<double> array_of(std::span<const glm::dvec3> points) {
  py::array_t<double> array({py::ssize_t(points.size()), py::ssize_t(3)});
  for (std::size_t p = 0; p < points.size(); ++p)
    for (int i = 0; i < 3; ++i) array.mutable_at(p, i) = points[p][i];
  return array;
}

py::array_t<double> array_of(const glm::dmat3& matrix) {
  py::array_t<double> array({3, 3});
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) array.mutable_at(row, column) = matrix[column][row];
  return array;
}

py::array_t<double> array_of(std::span<const RigidTransform> transforms) {
  py::array_t<double> array({py::ssize_t(transforms.size()), py::ssize_t(4), py::ssize_t(4)});
  for (std::size_t t = 0; t < transforms.size(); ++t) {
    const glm::dmat3 rotation = glm::mat3_cast(transforms[t].rotation);
    for (int row = 0; row < 4; ++row)
      for (int column = 0; column < 4; ++column)
        array.mutable_at(t, row, column) = row == 3      ? double(column == 3)
                                           : column == 3 ? transforms[t].translation[row]
                                                         : rotation[column][row];
  }
  return array;
}

glm::dvec3 vector_from(const Doubles& array, const std::string& name) {
  if (array.ndim() != 1 || array.shape(0) != 3) throw py::value_error(name + ": give three numbers (x, y, z)");
  check_finite(array, name);
  return {array.at(0), array.at(1), array.at(2)};
}

glm::dmat3 matrix_from(const Doubles& array, const std::string& name) {
  if (array.ndim() != 2 || array.shape(0) != 3 || array.shape(1) != 3)
    throw py::value_error(name + ": give a matrix of 3 x 3 numbers");
  check_finite(array, name);
  glm::dmat3 matrix;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) matrix[column][row] = array.at(row, column);
  return matrix;
}

std::vector<glm::dvec3> points_from(const Doubles& array, const std::string& name) {
  if (array.ndim() != 2 || array.shape(1) != 3) throw py::value_error(name + ": give an array of N x 3 numbers, in mm");
  check_finite(array, name);
  std::vector<glm::dvec3> points(array.shape(0));
  for (std::size_t p = 0; p < points.size(); ++p) points[p] = {array.at(p, 0), array.at(p, 1), array.at(p, 2)};
  return points;
}

}  // namespace limber::python
