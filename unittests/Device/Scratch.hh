// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_UNITTESTS_DEVICE_SCRATCH_HH
#define HFR_UNITTESTS_DEVICE_SCRATCH_HH

#include <stdlib.h>

#include <optional>
#include <string>

#include "ScratchFolder.hh"

namespace hfr::test {

/// An environment variable, set (or unset, by nullptr) until the object goes.
class ScopedVariable {
 public:
  ScopedVariable(const char* name, const char* value) : name_(name) {
    if (const char* old = getenv(name)) old_ = old;
    value ? setenv(name, value, 1) : unsetenv(name);
  }
  ~ScopedVariable() { old_ ? setenv(name_, old_->c_str(), 1) : unsetenv(name_); }
  ScopedVariable(const ScopedVariable&) = delete;
  ScopedVariable& operator=(const ScopedVariable&) = delete;

 private:
  const char* name_;
  std::optional<std::string> old_;
};

}  // namespace hfr::test

#endif
