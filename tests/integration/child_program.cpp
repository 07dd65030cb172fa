// SPDX-License-Identifier: Apache-2.0
#include "tests/integration/child_program.h"

#include <fcntl.h>
#include <spawn.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <iterator>
#include <thread>

namespace farfield {
namespace {

constexpr std::chrono::milliseconds kPollPeriod{10};

std::filesystem::path program_path(const std::string& name) {
  return std::filesystem::read_symlink("/proc/self/exe").parent_path() / name;
}

std::string read_text(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return std::string(std::istreambuf_iterator<char>(file), {});
}

}  // namespace

ChildProgram::ChildProgram(const std::string& name, const std::vector<std::string>& arguments) {
  std::string folder = (std::filesystem::temp_directory_path() / "farfield-program-XXXXXX").string();
  if (!mkdtemp(folder.data())) return;
  folder_ = folder;
  const std::string program = program_path(name).string();
  std::vector<char*> argument_list{const_cast<char*>(program.c_str())};
  for (const std::string& argument : arguments) argument_list.push_back(const_cast<char*>(argument.c_str()));
  argument_list.push_back(nullptr);

  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  constexpr int kWrite = O_WRONLY | O_CREAT | O_TRUNC;
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, (folder_ / "out").c_str(), kWrite, 0600);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, (folder_ / "errors").c_str(), kWrite, 0600);
  if (posix_spawn(&process_, program.c_str(), &actions, nullptr, argument_list.data(), environ) != 0) process_ = -1;
  posix_spawn_file_actions_destroy(&actions);
}

ChildProgram::~ChildProgram() {
  if (is_started() && !exit_code_) {
    kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
  }
  std::error_code ignored;
  if (!folder_.empty()) std::filesystem::remove_all(folder_, ignored);
}

std::string ChildProgram::out() const { return read_text(folder_ / "out"); }
std::string ChildProgram::error_out() const { return read_text(folder_ / "errors"); }

std::optional<std::string> ChildProgram::wait_for_line(const std::string& text, std::chrono::milliseconds timeout,
                                                       bool in_errors) {
  const auto until = std::chrono::steady_clock::now() + timeout;
  for (;;) {
    const bool is_over = wait(std::chrono::milliseconds(0)).has_value() || std::chrono::steady_clock::now() >= until;
    const std::string printed = in_errors ? error_out() : out();
    if (const std::size_t at = printed.find(text); at != std::string::npos) {
      const std::size_t end = printed.find('\n', at);
      const std::size_t before = printed.rfind('\n', at);
      const std::size_t begin = before == std::string::npos ? 0 : before + 1;
      if (end != std::string::npos) return printed.substr(begin, end - begin);
    }
    if (is_over) return std::nullopt;
    std::this_thread::sleep_for(kPollPeriod);
  }
}

void ChildProgram::send(int signal) {
  if (is_started() && !exit_code_) kill(process_, signal);
}

std::optional<int> ChildProgram::wait(std::chrono::milliseconds timeout) {
  const auto until = std::chrono::steady_clock::now() + timeout;
  while (is_started() && !exit_code_) {
    int status = 0;
    if (waitpid(process_, &status, WNOHANG) == process_) {
      exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    } else if (std::chrono::steady_clock::now() >= until) {
      break;
    } else {
      std::this_thread::sleep_for(kPollPeriod);
    }
  }
  return exit_code_;
}

}  // namespace farfield
