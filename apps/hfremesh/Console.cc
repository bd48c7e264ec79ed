// SPDX-License-Identifier: BSD-3-Clause
#include "Console.hh"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <system_error>

namespace hfr::app {
namespace {

std::string one_line(std::string text) {
  while (!text.empty() && text.back() == '\n') text.pop_back();
  // File names and file contents take part in messages; nothing in them may steer the terminal.
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }, ' ');
  return text;
}

}  // namespace

void put_out(const std::string& text) { static_cast<void>(std::fwrite(text.data(), 1, text.size(), stdout)); }

void put_err(const std::string& text) { static_cast<void>(std::fwrite(text.data(), 1, text.size(), stderr)); }

StandardStreams::StandardStreams() {
  for (const int number : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(number, F_GETFD) >= 0 || errno != EBADF) continue;
    // The wrong way round, so that using it fails as it would have. open() takes the smallest free number.
    static_cast<void>(open("/dev/null", number == STDIN_FILENO ? O_WRONLY : O_RDONLY));
  }
}

bool StandardStreams::arrived() {
  errno = 0;
  const bool flushed = std::fflush(stdout) == 0;
  const int error = errno;
  if (flushed && std::ferror(stdout) == 0) return std::ferror(stderr) == 0;
  // Whoever closes a pipe has seen enough.
  if (!said_ && error != EPIPE)
    print_error("the standard output cannot be written" +
                (error == 0 ? "" : ": " + std::generic_category().message(error)) +
                "; what was to be said there is lost");
  said_ = true;
  return false;
}

void print_error(const std::string& message) { put_err("hfremesh: " + one_line(message) + "\n"); }

void print_notes(const std::vector<std::string>& notes) {
  for (const std::string& note : notes) put_err("hfremesh: note: " + one_line(note) + "\n");
}

bool stderr_is_terminal() { return isatty(STDERR_FILENO) == 1; }

void ProgressView::show(const Progress& progress) {
  const double fraction = std::clamp(progress.fraction, 0.0, 1.0);
  const std::string state = fmt::format("{} {}: {} inverted, min dihedral {:.2f}", progress.stage,
                                        progress.iteration, progress.n_inverted, progress.min_dihedral);
  if (style_ == Style::kLines)
    put_err(fmt::format("hfremesh: progress: {:3.0f} % {}\n", 100 * fraction, state));
  if (style_ != Style::kBar) return;
  constexpr int kWidth = 20;
  const int done = static_cast<int>(fraction * kWidth);
  put_err(fmt::format("\r\x1b[K[{:#<{}}{:.<{}}] {:3.0f} % {}", "", done, "", kWidth - done, 100 * fraction,
                      state));
  drawn_ = true;
}

ProgressView::~ProgressView() {
  if (drawn_) put_err("\r\x1b[K");
}

}  // namespace hfr::app
