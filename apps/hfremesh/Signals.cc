// SPDX-License-Identifier: BSD-3-Clause
#include "Signals.hh"

#include <pthread.h>
#include <signal.h>
#include <unistd.h>

#include <cerrno>

#include "hfremesh/IO/OutputFile.hh"

namespace hfr::app {
namespace {

constexpr int kSignals[] = {SIGINT, SIGTERM, SIGHUP, SIGXCPU};

// A handler is handed nothing but the signal, so what it needs stands here.
volatile sig_atomic_t guarded = 0;         // a SignalGuard is there
volatile sig_atomic_t stop_requested = 0;  // it has been asked to stop
pthread_t main_thread;
pid_t main_process = 0;

void end_by(int signal) {
  struct sigaction action = {};
  action.sa_handler = SIG_DFL;
  sigaction(signal, &action, nullptr);
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, signal);
  pthread_sigmask(SIG_UNBLOCK, &set, nullptr);
  raise(signal);
}

/// Runs in the main thread, between two steps of its own: a file is then either listed or not yet made.
void handle(int signal) {
  const int error = errno;
  if (getpid() != main_process) {  // a child that has not become another program yet
    end_by(signal);
  } else if (!pthread_equal(pthread_self(), main_thread)) {
    pthread_kill(main_thread, signal);
  } else if (guarded && !stop_requested) {
    stop_requested = 1;
  } else if (guarded && signal == SIGXCPU) {
    // Linux sends it again each second beyond the soft limit; the hard one ends the process in any case.
  } else {
    io::remove_temporary_files();
    end_by(signal);
  }
  errno = error;
}

}  // namespace

void handle_signals() {
  main_thread = pthread_self();
  main_process = getpid();
  struct sigaction action = {};
  action.sa_handler = handle;
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  for (const int signal : kSignals) sigaddset(&action.sa_mask, signal);
  for (const int signal : kSignals) {
    struct sigaction old = {};
    sigaction(signal, nullptr, &old);
    if (signal == SIGHUP && old.sa_handler == SIG_IGN) continue;  // nohup
    sigaction(signal, &action, nullptr);
  }
  struct sigaction ignore = {};
  ignore.sa_handler = SIG_IGN;
  sigaction(SIGPIPE, &ignore, nullptr);
  sigaction(SIGXFSZ, &ignore, nullptr);
}

SignalGuard::SignalGuard() {
  stop_requested = 0;
  guarded = 1;
}

SignalGuard::~SignalGuard() { guarded = 0; }

bool SignalGuard::cancelled() const { return stop_requested != 0; }

}  // namespace hfr::app
