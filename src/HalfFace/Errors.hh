// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_HALFFACE_ERRORS_HH
#define HFR_HALFFACE_ERRORS_HH

#include <cassert>
#include <stdexcept>
#include <string>

namespace hfr {

/// Base of every error that the library throws. what() is one line that says where and what to do.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The caller's data breaks a rule: an index out of range, NaN, a face with three cells, a bad option.
class InvalidInput : public Error {
 public:
  using Error::Error;
};

/// A file cannot be opened, parsed or written.
class IoError : public Error {
 public:
  using Error::Error;
};

/// An OpenCL call failed, or there is no device of the kind that was asked for.
class DeviceError : public Error {
 public:
  using Error::Error;
};

/// More cells, vertices or memory than this build can hold.
class ResourceLimit : public Error {
 public:
  using Error::Error;
};

/// A fault of the library itself: what it made breaks a rule that it keeps. Worth a report.
class InternalError : public Error {
 public:
  using Error::Error;
};

}  // namespace hfr

/// Precondition of a public function; always on; throws hfr::InvalidInput.
#define HFR_REQUIRE(condition, message)                   \
  do {                                                    \
    if (!(condition)) throw ::hfr::InvalidInput(message); \
  } while (false)

/// Internal invariant; debug builds only.
#define HFR_ASSERT(condition) assert(condition)

// The third level is a macro of the build: with HFR_PARANOID defined (cmake -DHFR_PARANOID=ON), the whole
// mesh is checked and the whole workspace counted anew round each round and each smoothing pass, and
// InternalError names the operator and the first difference. Linear in the mesh however little a round does,
// so for small meshes: about 1 µs a cell and round, and a copy of the mesh. Nothing of it is compiled
// otherwise. See Scheduler/Paranoid.hh.

#endif
