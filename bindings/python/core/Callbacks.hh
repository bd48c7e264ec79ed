// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_BINDINGS_PYTHON_CALLBACKS_HH
#define HFR_BINDINGS_PYTHON_CALLBACKS_HH

#include <nanobind/nanobind.h>

#include <utility>

#include "hfremesh/Remesh/Options.hh"

namespace hfr::python {

namespace nb = nanobind;

/// What a run calls back, while the interpreter is free for others. KeyboardInterrupt, of a signal or of what
/// was called, is no error but the wish to end. What else is raised goes on, through the run and out of it.
class Callbacks {
 public:
  /// Either may be None. Both must outlive this object.
  Callbacks(nb::handle progress, nb::handle cancel) : progress_(progress), cancel_(cancel) {}
  Callbacks(const Callbacks&) = delete;
  Callbacks& operator=(const Callbacks&) = delete;

  /// The options refer to this object from then on.
  void attach(ImproveOptions& options) {
    // A look at every cell for each call, so only where somebody listens.
    if (!progress_.is_none())
      options.progress = [this](const Progress& now) {
        with_python([&] { progress_(nb::cast(now, nb::rv_policy::copy)); });
      };
    options.cancel = [this] { return wants_end(); };
  }
  /// Before each run: forgets an interrupt of the one before.
  void begin() { interrupted_ = false; }
  /// Nobody is called from then on.
  void forget() { progress_ = cancel_ = nb::none(); }

 private:
  template <class F>
  void with_python(F&& f) {
    const nb::gil_scoped_acquire python;
    try {
      if (PyErr_CheckSignals() != 0) throw nb::python_error();
      f();
    } catch (nb::python_error& error) {
      if (!error.matches(PyExc_KeyboardInterrupt)) throw;
      interrupted_ = true;
    }
  }

  bool wants_end() {
    bool asked = false;
    with_python([&] { asked = !cancel_.is_none() && nb::cast<bool>(nb::bool_(nb::object(cancel_()))); });
    return interrupted_ || asked;
  }

  nb::handle progress_, cancel_;
  bool interrupted_ = false;
};

}  // namespace hfr::python

#endif
