// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_APPS_CONSOLE_HH
#define HFR_APPS_CONSOLE_HH

#include <fmt/format.h>

#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include "hfremesh/Remesh/Improve.hh"

namespace hfr::app {

/// Writes to the standard streams never throw: a report that is lost must not cost the run. Whether all of it
/// arrived is asked in the end.
void put_out(const std::string& text);
void put_err(const std::string& text);

/// Formatted text on stdout.
template <class... Args>
void print(fmt::format_string<Args...> format, Args&&... args) {
  put_out(fmt::format(format, std::forward<Args>(args)...));
}

/// The three standard streams, from the first line of main() on.
class StandardStreams {
 public:
  /// Holds the places of those that are closed, so that no file that is opened later gets its number and the
  /// reports that go there.
  StandardStreams();
  StandardStreams(const StandardStreams&) = delete;
  StandardStreams& operator=(const StandardStreams&) = delete;

  /// False when something that was to be said has been lost so far; says so, once, where that still goes.
  bool arrived();

 private:
  bool said_ = false;
};

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

}  // namespace hfr::app

#endif
