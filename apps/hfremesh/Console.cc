// SPDX-License-Identifier: BSD-3-Clause
#include "Console.hh"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>

namespace hfr::app {
namespace {

std::string one_line(std::string text) {
  while (!text.empty() && text.back() == '\n') text.pop_back();
  // File names and file contents take part in messages; nothing in them may steer the terminal.
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }, ' ');
  return text;
}

/// The only state that a signal handler may write.
volatile std::sig_atomic_t stop_requested = 0;

void request_stop(int) { stop_requested = 1; }

void set_handler(void (*handler)(int), int flags) {
  struct sigaction action = {};
  action.sa_handler = handler;
  action.sa_flags = flags;
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

}  // namespace

void print_error(const std::string& message) { fmt::print(stderr, "hfremesh: {}\n", one_line(message)); }

void print_notes(const std::vector<std::string>& notes) {
  for (const std::string& note : notes) fmt::print(stderr, "hfremesh: note: {}\n", one_line(note));
}

bool stderr_is_terminal() { return isatty(STDERR_FILENO) == 1; }

void ProgressView::show(const Progress& progress) {
  const double fraction = std::clamp(progress.fraction, 0.0, 1.0);
  const std::string state = fmt::format("{} {}: {} inverted, min dihedral {:.2f}", progress.stage,
                                        progress.iteration, progress.n_inverted, progress.min_dihedral);
  if (style_ == Style::kLines)
    fmt::print(stderr, "hfremesh: progress: {:3.0f} % {}\n", 100 * fraction, state);
  if (style_ != Style::kBar) return;
  constexpr int kWidth = 20;
  const int done = static_cast<int>(fraction * kWidth);
  fmt::print(stderr, "\r\x1b[K[{:#<{}}{:.<{}}] {:3.0f} % {}", "", done, "", kWidth - done, 100 * fraction,
             state);
  std::fflush(stderr);
  drawn_ = true;
}

ProgressView::~ProgressView() {
  if (!drawn_) return;
  std::fputs("\r\x1b[K", stderr);
  std::fflush(stderr);
}

SignalGuard::SignalGuard() {
  stop_requested = 0;
  set_handler(request_stop, static_cast<int>(SA_RESETHAND) | SA_RESTART);
}

SignalGuard::~SignalGuard() { set_handler(SIG_DFL, 0); }

bool SignalGuard::cancelled() const { return stop_requested != 0; }

}  // namespace hfr::app
