// SPDX-License-Identifier: Apache-2.0
// One of Farfield's programs, run as its users run it: started, watched, ended. It stands beside the test program.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace farfield {

/// Owns the process: it never outlives this object. One thread.
class ChildProgram {
 public:
  /// Starts `name` with `arguments`; what it prints is kept in files of a temporary folder.
  ChildProgram(const std::string& name, const std::vector<std::string>& arguments);
  ChildProgram(const ChildProgram&) = delete;
  ChildProgram& operator=(const ChildProgram&) = delete;
  ~ChildProgram();

  bool is_started() const { return process_ > 0; }
  /// What it has printed so far.
  std::string out() const;
  std::string error_out() const;
  /// Waits until standard output (or, `in_errors`, standard error) holds a whole line with `text`.
  /// Returns: that line, or nothing if the time is over or the process has ended without it.
  std::optional<std::string> wait_for_line(const std::string& text, std::chrono::milliseconds timeout, bool in_errors = false);
  void send(int signal);
  /// Returns: the exit code, 128 + the signal that ended it, or nothing if it still runs after `timeout`.
  std::optional<int> wait(std::chrono::milliseconds timeout);

 private:
  std::filesystem::path folder_;
  pid_t process_ = -1;
  std::optional<int> exit_code_;
};

}  // namespace farfield
