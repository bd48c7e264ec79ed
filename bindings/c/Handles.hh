// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_BINDINGS_C_HANDLES_HH
#define HFR_BINDINGS_C_HANDLES_HH

#include <exception>
#include <new>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "hfremesh.h"
#include "hfremesh/HalfFace/Errors.hh"
#include "hfremesh/HalfFace/TetMesh.hh"
#include "hfremesh/Remesh/Improve.hh"
#include "hfremesh/Remesh/Remesher.hh"

struct hfr_options {
  /// A field that the caller carries over himself.
  struct OnTransfer {
    std::string name;
    hfr_transfer_callback call;
    void* user;
  };
  hfr::ImproveOptions options;          ///< of hfr_improve()
  hfr::RemesherOptions remesher;        ///< what of it was set, too, and what is a remesher's alone
  std::vector<OnTransfer> on_transfer;  ///< a remesher's, too
  std::string message;
};

struct hfr_mesh {
  hfr::TetMesh tets;
  int base = 0;
  hfr::MeshMaps maps;                          ///< of the last run
  std::vector<hfr::CellHandle> invalid_cells;  ///< that it has left
  std::string message;
};

namespace hfr::c {

/// Runs f, whose messages count cells and vertices as the library does; says so where the caller does not.
template <class F>
void counted_from_zero(const hfr_mesh& mesh, F&& f) {
  try {
    f();
  } catch (const InvalidInput& error) {
    if (mesh.base == 0) throw;
    throw InvalidInput(std::string(error.what()) + " (cells and vertices counted from 0)");
  }
}

inline void keep(std::string& message, const char* text) {
  try {
    message = text;
  } catch (...) {  // no memory, and no line
    message.clear();
  }
}

/// Runs f; what it throws becomes a status and the handle's message. The only way out of this library.
template <class Handle, class F>
hfr_status guarded(Handle* handle, F&& f) noexcept {
  if (!handle) return HFR_INVALID_INPUT;
  handle->message.clear();
  try {
    f();
    return HFR_OK;
  } catch (const InvalidInput& error) {
    keep(handle->message, error.what());
    return HFR_INVALID_INPUT;
  } catch (const IoError& error) {
    keep(handle->message, error.what());
    return HFR_IO_ERROR;
  } catch (const DeviceError& error) {
    keep(handle->message, error.what());
    return HFR_DEVICE_ERROR;
  } catch (const ResourceLimit& error) {
    keep(handle->message, error.what());
    return HFR_RESOURCE_LIMIT;
  } catch (const std::bad_alloc&) {
    keep(handle->message, "not enough memory");
    return HFR_RESOURCE_LIMIT;
  } catch (const std::length_error&) {
    keep(handle->message, "not enough memory");
    return HFR_RESOURCE_LIMIT;
  } catch (const std::exception& error) {
    keep(handle->message, error.what());
    return HFR_INTERNAL_ERROR;
  } catch (...) {
    keep(handle->message, "a callback threw what is no exception");
    return HFR_INTERNAL_ERROR;
  }
}

/// Throws InvalidInput for NULL.
inline std::string_view text_of(const char* text, const char* what) {
  HFR_REQUIRE(text, std::string(what) + " is NULL");
  return text;
}

}  // namespace hfr::c

#endif
