// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_APPS_CONSOLE_HH
#define HFR_APPS_CONSOLE_HH

#include <chrono>
#include <string>
#include <vector>

#include "Remesh/Improve.hh"

namespace hfr::app {

/// "hfremesh: MESSAGE" on stderr, as one line whatever the message holds.
void print_error(const std::string& message);
/// "hfremesh: note: MESSAGE" on stderr, a line each.
void print_notes(const std::vector<std::string>& notes);

/// Shows how far a run is: a bar that redraws itself on a terminal, whole lines where `plain`, else nothing.
/// Everything goes to stderr. Clears the bar when it ends.
class ProgressView {
 public:
  enum class Style { kNone, kBar, kLines };
  explicit ProgressView(Style style) : style_(style) {}
  ~ProgressView();
  ProgressView(const ProgressView&) = delete;
  ProgressView& operator=(const ProgressView&) = delete;

  void show(const Progress& progress);

 private:
  Style style_;
  bool drawn_ = false;
};

/// Whether stderr is a terminal.
bool stderr_is_terminal();

/// Seconds between construction and calls.
class Stopwatch {
 public:
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// From its construction on, SIGINT and SIGTERM ask the run to stop instead of ending the process; a second
/// one ends it. One object at a time.
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
