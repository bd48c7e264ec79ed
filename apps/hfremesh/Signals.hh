// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_APPS_SIGNALS_HH
#define HFR_APPS_SIGNALS_HH

namespace hfr::app {

/// From now on SIGINT, SIGTERM, SIGHUP and SIGXCPU remove half-written files before they end the process, and
/// a pipe without reader or a file that may not grow is an error of the write. To be called once, in the
/// thread that writes files, before there are others.
void handle_signals();

/// While it is there, the first of these signals asks the run to stop instead of ending the process. One
/// object at a time.
class SignalGuard {
 public:
  SignalGuard();
  ~SignalGuard();
  SignalGuard(const SignalGuard&) = delete;
  SignalGuard& operator=(const SignalGuard&) = delete;

  bool cancelled() const;
};

}  // namespace hfr::app

#endif
