// SPDX-License-Identifier: BSD-3-Clause
// hfremesh._core: the library's types and functions as they are; what makes them comfortable is Python, in
// bindings/python/hfremesh.
#include <nanobind/nanobind.h>

#include "Mesh.hh"
#include "hfremesh/HalfFace/Config.hh"
#include "hfremesh/HalfFace/Errors.hh"

namespace nb = nanobind;

namespace {

PyObject* device_error = nullptr;  // of the interpreter: lives as long as the module

void translate(const std::exception_ptr& pointer, void*) {
  try {
    std::rethrow_exception(pointer);
  } catch (const hfr::InvalidInput& error) {
    PyErr_SetString(PyExc_ValueError, error.what());
  } catch (const hfr::IoError& error) {
    PyErr_SetString(PyExc_OSError, error.what());
  } catch (const hfr::ResourceLimit& error) {
    PyErr_SetString(PyExc_MemoryError, error.what());
  } catch (const hfr::DeviceError& error) {
    PyErr_SetString(device_error, error.what());
  } catch (const hfr::Error& error) {
    PyErr_SetString(PyExc_RuntimeError, error.what());
  }
}

}  // namespace

NB_MODULE(_core, module) {
  module.doc() = "Half-face meshes of tetrahedra and what is done with them.";
  module.attr("__version__") = HFR_VERSION;
  device_error =
      PyErr_NewExceptionWithDoc("hfremesh.DeviceError", "The device that was named is missing, or it failed.",
                                PyExc_RuntimeError, nullptr);
  module.attr("DeviceError") = nb::borrow(device_error);
  nb::register_exception_translator(translate);
  hfr::python::bind_mesh(module);
  hfr::python::bind_statistics(module);
  hfr::python::bind_edits(module);
  hfr::python::bind_improve(module);
  hfr::python::bind_remesher(module);
  hfr::python::bind_files(module);
}
