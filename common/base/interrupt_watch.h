// SPDX-License-Identifier: Apache-2.0
// Notices Ctrl-C and SIGTERM without signal handlers: the signals are blocked and a thread waits for them.
#pragma once

#include <atomic>
#include <csignal>
#include <cstdlib>
#include <ctime>
#include <thread>

namespace farfield {

class InterruptWatch {
 public:
  /// Requires: made before any other thread, which would otherwise not inherit the blocked signals.
  InterruptWatch() {
    sigemptyset(&signals_);
    sigaddset(&signals_, SIGINT);
    sigaddset(&signals_, SIGTERM);
    pthread_sigmask(SIG_BLOCK, &signals_, &former_);
    thread_ = std::thread([this] { run(); });
  }
  ~InterruptWatch() {
    is_over_ = true;
    thread_.join();
    pthread_sigmask(SIG_SETMASK, &former_, nullptr);
  }
  InterruptWatch(const InterruptWatch&) = delete;
  InterruptWatch& operator=(const InterruptWatch&) = delete;

  /// Stays true. The first interrupt asks the program to end in order; another one ends it at once.
  const std::atomic<bool>& is_interrupted() const { return is_interrupted_; }

 private:
  void run() {
    constexpr timespec kGlance{0, 50'000'000};  // how soon the destructor is noticed
    while (!is_over_) {
      if (sigtimedwait(&signals_, nullptr, &kGlance) <= 0) continue;
      if (is_interrupted_.exchange(true)) std::_Exit(130);
    }
  }

  sigset_t signals_, former_;
  std::atomic<bool> is_over_{false}, is_interrupted_{false};
  std::thread thread_;
};

}  // namespace farfield
