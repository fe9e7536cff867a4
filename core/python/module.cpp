// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/python/module.h"

#include "core/base/error.h"
#include "core/base/parallel.h"

namespace py = pybind11;

namespace limber::python {

namespace {
void set_thread_count(int threads) {
  static std::unique_ptr<ThreadCount> limit;
  if (threads < 0) throw py::value_error("threads: give 1 or more, or 0 for all cores");
  limit.reset();
  if (threads > 0) limit = std::make_unique<ThreadCount>(threads);
}
}  // namespace

}  // namespace limber::python

PYBIND11_MODULE(_limber, module) {
  using namespace limber;
  module.doc() = "Poses labelled voxel anatomy: volumes, rigs, weights, poses, resampling.";
  module.attr("__version__") = LIMBER_VERSION;
  py::register_exception<Error>(module, "Error", PyExc_RuntimeError);
  py::register_exception<Cancelled>(module, "Cancelled", PyExc_RuntimeError);
  module.attr("LimberWarning") =
      py::reinterpret_steal<py::object>(PyErr_NewException("limber.LimberWarning", PyExc_UserWarning, nullptr));
  module.def("set_thread_count", &python::set_thread_count, py::arg("threads"),
             "Sets the number of threads of every following call; 0: all cores. Results do not depend on the number.");
  python::add_volumes(module);
  python::add_rigs(module);
  python::add_motions(module);
  python::add_bodies(module);
  python::add_previews(module);
}
