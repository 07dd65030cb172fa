// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/client_process.h"

#include <csignal>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <memory>

namespace farfield::bench {
namespace {

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, CloseFile>;

struct Child {
  pid_t id = -1;
  File in, out;  // seen from here: its standard output and input
};

Result<Child> start_child(const std::vector<std::string>& words) {
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  int from_child[2], to_child[2];
  if (pipe(from_child) != 0) return fail(ErrorCode::kIo, "no pipe to the client process");
  if (pipe(to_child) != 0) {
    close(from_child[0]), close(from_child[1]);
    return fail(ErrorCode::kIo, "no pipe to the client process");
  }
  Child child;
  child.id = fork();
  if (child.id == 0) {
    dup2(from_child[1], STDOUT_FILENO), dup2(to_child[0], STDIN_FILENO);
    for (const int end : {from_child[0], from_child[1], to_child[0], to_child[1]}) close(end);
    execv("/proc/self/exe", arguments.data());
    _exit(127);
  }
  close(from_child[1]), close(to_child[0]);
  child.in.reset(fdopen(from_child[0], "r"));
  child.out.reset(fdopen(to_child[1], "w"));
  if (child.id < 0) return fail(ErrorCode::kIo, "the client process cannot be started");
  return child;
}

/// Pauses the pool at most once, and lets it go on when the client is gone.
class Quiet {
 public:
  explicit Quiet(JobPool& pool) : pool_(pool) {}
  ~Quiet() { end(); }
  Quiet(const Quiet&) = delete;
  Quiet& operator=(const Quiet&) = delete;
  void begin() {
    if (!is_on_) pool_.pause();
    is_on_ = true;
  }
  void end() {
    if (is_on_) pool_.resume();
    is_on_ = false;
  }

 private:
  JobPool& pool_;
  bool is_on_ = false;
};

/// Answers the client until it has closed its output. Returns: its last line.
std::string converse(const Child& child, JobPool& pool) {
  Quiet quiet(pool);
  std::string last;
  char* line = nullptr;
  std::size_t capacity = 0;
  for (ssize_t length; (length = getline(&line, &capacity, child.in.get())) > 0;) {
    last.assign(line, static_cast<std::size_t>(length));
    if (!last.empty() && last.back() == '\n') last.pop_back();
    if (last == kQuiet) {
      quiet.begin();
      std::fprintf(child.out.get(), "%s\n", kIsQuiet);
      std::fflush(child.out.get());
    } else if (last == kGoOn) {
      quiet.end();
    }
  }
  free(line);
  return last;
}

}  // namespace

Result<nlohmann::json> run_client(const Display& d, const ClientRun& run, JobPool& pool) {
  std::signal(SIGPIPE, SIG_IGN);  // a client that died is seen by its output's end
  const Result<Child> child = start_child(
      {"farfield-bench", "--role", "client", "--endpoint", to_string(run.endpoint), "--renderer", run.renderer, "--mode",
       run.mode, "--folder", run.folder.string(), "--trace", run.trace.string(), "--frames",
       std::to_string(run.frames), "--size", fmt::format("{}x{}", d.width, d.height), "--fovy",
       fmt::format("{:.12g}", d.fovy_rad * 180 / 3.14159265358979323846), "--client-samples",
       std::to_string(run.samples)});
  if (!child) return tl::unexpected(child.error());
  const std::string text = converse(*child, pool);
  int status = 0;
  waitpid(child->id, &status, 0);
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    const bool has_said_why = text.starts_with(kFailed);
    return fail(ErrorCode::kUnavailable, "{} {}: the client failed: {}", run.renderer, run.mode,
                has_said_why ? text.substr(kFailed.size()) : fmt::format("it ended with status {:#x}", status));
  }
  nlohmann::json json = nlohmann::json::parse(text, nullptr, false);
  if (json.is_discarded()) return fail(ErrorCode::kBadData, "the client's report is not JSON");
  return json;
}

}  // namespace farfield::bench
