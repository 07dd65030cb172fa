// SPDX-License-Identifier: Apache-2.0
#include "server/model/import_process.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <utility>

#include "server/model/model_stream.h"

extern char** environ;

namespace farfield {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kOutputDescriptor = 3;             // where the import process finds its output
constexpr std::size_t kMaxTalkBytes = 16 << 10;  // of what it says on stderr; the rest is read and forgotten

class Descriptor {
 public:
  explicit Descriptor(int value = -1) : value_(value) {}
  Descriptor(Descriptor&& other) noexcept : value_(std::exchange(other.value_, -1)) {}
  Descriptor& operator=(Descriptor&&) = delete;
  ~Descriptor() { close(); }
  int get() const { return value_; }
  void close() {
    if (value_ >= 0) ::close(std::exchange(value_, -1));
  }

 private:
  int value_;
};

struct MappedView {
  void* data = MAP_FAILED;
  std::size_t size = 0;
  ~MappedView() {
    if (data != MAP_FAILED) munmap(data, size);
  }
};

std::filesystem::path program_beside_this() {
  std::error_code error;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
  return self.parent_path() / "farfield-import";
}

struct Ending {
  int status = 0;
  bool is_timed_out = false;
  std::string talk;  // stderr
};

/// Starts the program with its output and stderr in place, everything else on /dev/null.
Result<pid_t> spawn(const std::filesystem::path& program, const std::filesystem::path& path, int output, int talk,
                    const ImportProcessOptions& options) {
  const std::string file = path.string(), descriptor = std::to_string(kOutputDescriptor);
  const std::string memory = std::to_string(options.memory_limit_bytes),
                    seconds = std::to_string(options.time_limit.count());
  const char* arguments[] = {program.c_str(), file.c_str(),    descriptor.c_str(),
                             memory.c_str(),  seconds.c_str(), nullptr};
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, talk, 2);
  posix_spawn_file_actions_adddup2(&actions, output, kOutputDescriptor);
  pid_t process = -1;
  const int error = posix_spawn(&process, program.c_str(), &actions, nullptr, const_cast<char**>(arguments), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) {
    return fail(ErrorCode::kInternal, "{}: the import program cannot be started ({}); install it beside this program",
                program.string(), std::strerror(error));
  }
  return process;
}

/// Reads what the process says until it closes its end or the time is up; then ends and collects it.
Ending wait_for(pid_t process, int talk, Clock::time_point deadline) {
  Ending ending;
  char buffer[4096];
  for (;;) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()).count();
    if (left <= 0) {
      ending.is_timed_out = true;
      break;
    }
    pollfd waiting{.fd = talk, .events = POLLIN};
    const int ready = poll(&waiting, 1, static_cast<int>(std::min<long long>(left, 1000)));
    if (ready == 0 || (ready < 0 && errno == EINTR)) continue;
    const ssize_t count = ready < 0 ? -1 : read(talk, buffer, sizeof(buffer));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    const std::size_t room = kMaxTalkBytes - std::min(kMaxTalkBytes, ending.talk.size());
    ending.talk.append(buffer, std::min(room, static_cast<std::size_t>(count)));
  }
  if (ending.is_timed_out) kill(process, SIGKILL);
  while (waitpid(process, &ending.status, 0) < 0 && errno == EINTR) {
  }
  return ending;
}

std::string last_line(const std::string& text) {
  std::size_t end = text.find_last_not_of(" \r\n");
  if (end == text.npos) return {};
  const std::size_t start = text.find_last_of('\n', end);
  return text.substr(start == text.npos ? 0 : start + 1, end - (start == text.npos ? 0 : start + 1) + 1);
}

tl::unexpected<Error> failure_of(const std::filesystem::path& path, const Ending& ending,
                                 const ImportProcessOptions& options) {
  const std::string file = path.string(), line = last_line(ending.talk);
  const bool is_signal = WIFSIGNALED(ending.status);
  if (ending.is_timed_out || (is_signal && WTERMSIG(ending.status) == SIGXCPU)) {
    return fail(ErrorCode::kLimitExceeded, "{}: import stopped after {} s; simplify or split the file", file,
                options.time_limit.count());
  }
  if (line.find("more memory than the import") != line.npos || line.find("File too large") != line.npos ||
      line.find("bad_alloc") != line.npos || (is_signal && WTERMSIG(ending.status) == SIGKILL)) {
    return fail(ErrorCode::kLimitExceeded,
                "{}: import needs more than the {} MB allowed; split the file or raise the limit", file,
                options.memory_limit_bytes >> 20);
  }
  if (is_signal) {
    return fail(ErrorCode::kBadData, "{}: the importer crashed on this file ({}{}{}); repair or convert it", file,
                strsignal(WTERMSIG(ending.status)), line.empty() ? "" : ": ", line);
  }
  if (line.starts_with(file)) return fail(ErrorCode::kBadData, "{}", line);
  return fail(ErrorCode::kBadData, "{}: cannot be imported: {}; repair or convert it", file,
              line.empty() ? "the importer gave no reason" : line);
}

}  // namespace

Result<Model> import_in_process(const std::filesystem::path& path, const ImportProcessOptions& options) {
  const std::filesystem::path program = options.program.empty() ? program_beside_this() : options.program;
  const Descriptor output(memfd_create("farfield-model", MFD_CLOEXEC));
  int ends[2];
  if (output.get() < 0 || pipe2(ends, O_CLOEXEC) != 0) {
    return fail(ErrorCode::kIo, "{}: no descriptors left to start an import: {}", path.string(), std::strerror(errno));
  }
  const Descriptor talk(ends[0]);
  Descriptor child_talk(ends[1]);
  const Clock::time_point deadline = Clock::now() + 2 * options.time_limit;
  const Result<pid_t> process = spawn(program, path, output.get(), child_talk.get(), options);
  if (!process) return tl::unexpected(process.error());
  child_talk.close();
  const Ending ending = wait_for(*process, talk.get(), deadline);
  if (ending.is_timed_out || !WIFEXITED(ending.status) || WEXITSTATUS(ending.status) != 0) {
    return failure_of(path, ending, options);
  }

  MappedView view;
  struct stat information {};
  if (fstat(output.get(), &information) == 0 && information.st_size > 0) {
    view.size = static_cast<std::size_t>(information.st_size);
    view.data = mmap(nullptr, view.size, PROT_READ, MAP_PRIVATE, output.get(), 0);
  }
  if (view.data == MAP_FAILED)
    return fail(ErrorCode::kIo, "{}: the imported model cannot be taken over", path.string());
  Result<Model> model = read_model_stream({static_cast<const std::uint8_t*>(view.data), view.size});
  if (!model) return fail_within(path.string(), model.error());
  return model;
}

}  // namespace farfield
