// SPDX-License-Identifier: Apache-2.0
#include "server/app/prepared_scenes.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "common/base/complete_file.h"
#include "generated/scene_fingerprint.h"
#include "server/app/walk_path.h"
#include "server/model/source_files.h"

namespace farfield {
namespace {

using Log = std::function<void(const std::string&)>;
using Clock = std::chrono::steady_clock;

constexpr const char* kSuffix = ".scene";

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

void say(const Log& log, const std::string& line) {
  if (log) log(line);
}

/// What a file holds besides the scene.
struct Preparation {
  std::string request;  // argument and options: their hash is the file's name
  std::vector<SourceFile> sources;
  std::vector<std::string> warnings;
  PreparedScene prepared;
};

struct Loading {
  std::vector<std::string> sources, warnings;
  PreparedScene prepared;
};

Result<Loading> load_and_build(const std::string& argument, const LoadOptions& load, const Log& log) {
  const Clock::time_point start = Clock::now();
  Result<Model> model = load_model(argument, load);
  if (!model) return tl::unexpected(model.error());
  Loading loading{std::move(model->sources), std::move(model->warnings), {}};
  for (const std::string& warning : loading.warnings) say(log, "warning: " + warning);
  say(log, fmt::format("loaded in {:.2f} s, {} triangles", seconds_since(start), model->drawn_triangles()));
  const Clock::time_point build_start = Clock::now();
  Result<std::shared_ptr<const Scene>> scene = Scene::build(std::move(*model));
  if (!scene) return fail_within(argument, scene.error());
  loading.prepared = prepared(std::move(*scene));
  say(log, fmt::format("built in {:.2f} s, {} chunks", seconds_since(build_start), loading.prepared.scene->statistics().chunks));
  return loading;
}

/// Everything that can make the same argument mean another scene, but for the files' content.
std::string request_of(const std::string& argument, const LoadOptions& load) {
  std::error_code ignored;
  const std::string place = std::filesystem::exists(argument, ignored) ? std::filesystem::absolute(argument).lexically_normal().string() : argument;
  return fmt::format("{} units {} up {} shift {} {} {}", place, load.metres_per_unit, load.up, load.shift.x, load.shift.y, load.shift.z);
}

class MappedFile {
 public:
  explicit MappedFile(const std::filesystem::path& path) {
    const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor < 0) return;
    struct stat status {};
    if (fstat(descriptor, &status) == 0 && status.st_size > 0) {
      size_ = static_cast<std::size_t>(status.st_size);
      data_ = mmap(nullptr, size_, PROT_READ, MAP_PRIVATE | MAP_POPULATE, descriptor, 0);
    }
    ::close(descriptor);
  }
  ~MappedFile() {
    if (data_ != MAP_FAILED) munmap(data_, size_);
  }
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;
  /// Empty: there is no such file.
  ByteView bytes() const { return data_ == MAP_FAILED ? ByteView() : ByteView(static_cast<const std::uint8_t*>(data_), size_); }

 private:
  void* data_ = MAP_FAILED;
  std::size_t size_ = 0;
};

void write_preparation(const Preparation& preparation, MemoryImageWriter& out) {
  out.put_text(FARFIELD_SCENE_FINGERPRINT);
  out.put_text(preparation.request);
  write_sources(preparation.sources, out);
  out.put_texts(preparation.warnings);
  out.put<std::uint8_t>(preparation.prepared.standing.has_value());
  out.put(preparation.prepared.standing.value_or(glm::dvec3(0)));
  preparation.prepared.scene->write(out);
}

/// Errors: kBadData (damaged), kVersionMismatch (another build's), kNotFound (a source has changed, or it is of something else).
Result<Preparation> read_preparation(ByteView file, const std::string& request) {
  if (file.size() < sizeof(ContentHash)) return fail(ErrorCode::kBadData, "it is damaged");
  const ByteView bytes = file.first(file.size() - sizeof(ContentHash));
  // Before the hash: a file of another build is no damaged one.
  MemoryImageReader in(bytes);
  if (in.get_text() != FARFIELD_SCENE_FINGERPRINT) return fail(ErrorCode::kVersionMismatch, "it is of another build of Farfield");
  if (memory_image_hash(bytes) != ByteReader(file.last(sizeof(ContentHash))).get<ContentHash>()) return fail(ErrorCode::kBadData, "it is damaged");
  Preparation preparation;
  preparation.request = in.get_text();
  preparation.sources = read_sources(in);
  preparation.warnings = in.get_texts();
  const bool has_standing = in.get<std::uint8_t>() != 0;
  const auto standing = in.get<glm::dvec3>();
  if (has_standing) preparation.prepared.standing = standing;
  if (!in.is_valid()) return fail(ErrorCode::kBadData, "it is damaged");
  if (preparation.request != request) return fail(ErrorCode::kNotFound, "it is of another scene");
  if (const std::string changed = find_changed(preparation.sources); !changed.empty()) return fail(ErrorCode::kNotFound, "{} has changed", changed);
  Result<std::shared_ptr<const Scene>> scene = Scene::restore(in);
  if (!scene) return tl::unexpected(scene.error());
  preparation.prepared.scene = std::move(*scene);
  return preparation;
}

struct KeptFile {
  std::filesystem::path path;
  std::filesystem::file_time_type used;
  std::uint64_t bytes = 0;
};

/// Removes the least recently used files but `kept` until `room` bytes more fit.
void make_room(const std::filesystem::path& folder, const std::filesystem::path& kept, std::uint64_t room, std::uint64_t capacity) {
  std::vector<KeptFile> files;
  std::error_code ignored;
  std::uint64_t total = room;
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
    if (entry.path().extension() != kSuffix || entry.path() == kept) continue;
    files.push_back({entry.path(), entry.last_write_time(ignored), entry.file_size(ignored)});
    total += files.back().bytes;
  }
  std::sort(files.begin(), files.end(), [](const KeptFile& a, const KeptFile& b) { return a.used < b.used; });
  for (std::size_t i = 0; i < files.size() && total > capacity; ++i) {
    std::filesystem::remove(files[i].path, ignored);
    total -= files[i].bytes;
  }
}

struct Stopped {};

Status write_file(const std::filesystem::path& path, const Preparation& preparation, std::uint64_t capacity, const std::stop_token& stop) {
  // Its size is counted first: nothing is removed for what does not fit, and writing to nowhere takes a tenth of the time.
  std::uint64_t bytes = sizeof(ContentHash);
  MemoryImageWriter measure([&bytes](ByteView block) { bytes += block.size(); });
  write_preparation(preparation, measure);
  measure.flush();
  if (bytes > capacity) {
    return fail(ErrorCode::kLimitExceeded, "its {} MiB are more than the {} MiB that prepared scenes may take; raise --store-bytes", bytes >> 20,
                capacity >> 20);
  }
  std::error_code error;
  std::filesystem::create_directories(path.parent_path(), error);
  if (error) return fail(ErrorCode::kIo, "the folder {} cannot be made: {}", path.parent_path().string(), error.message());
  make_room(path.parent_path(), path, bytes, capacity);
  Result<CompleteFile> file = CompleteFile::create(path);
  if (!file) return tl::unexpected(file.error());
  MemoryImageWriter out([&](ByteView block) {
    if (stop.stop_requested()) throw Stopped{};
    file->write(block);
  });
  try {
    write_preparation(preparation, out);
    out.flush();
  } catch (const Stopped&) {
    return fail(ErrorCode::kCancelled, "the program ended before it was written");
  }
  const ContentHash hash = out.hash();
  file->write({reinterpret_cast<const std::uint8_t*>(&hash), sizeof(hash)});
  return file->commit();
}

}  // namespace

void PreparedScenes::finish() {
  for (std::jthread& writer : writers_) writer.join();
  writers_.clear();
}

PreparedScene prepared(std::shared_ptr<const Scene> scene) {
  const Result<glm::dvec3> standing = standing_point(*scene, 1);
  return {std::move(scene), standing ? std::optional(*standing) : std::nullopt};
}

Result<PreparedScene> prepare_scene(const std::string& argument, const LoadOptions& load, const Log& log) {
  Result<Loading> loading = load_and_build(argument, load, log);
  if (!loading) return tl::unexpected(loading.error());
  return std::move(loading->prepared);
}

Result<PreparedScene> PreparedScenes::open(const std::string& argument, const LoadOptions& load, Log log) {
  const std::string request = request_of(argument, load);
  const ContentHash name = hash_bytes({reinterpret_cast<const std::uint8_t*>(request.data()), request.size()});
  const std::filesystem::path path = folder_ / fmt::format("{:016x}{}", name, kSuffix);
  const Clock::time_point start = Clock::now();
  {
    const MappedFile file(path);
    if (!file.bytes().empty()) {
      Result<Preparation> read = read_preparation(file.bytes(), request);
      if (read) {
        std::error_code ignored;
        std::filesystem::last_write_time(path, std::filesystem::file_time_type::clock::now(), ignored);
        for (const std::string& warning : read->warnings) say(log, "warning: " + warning);
        say(log, fmt::format("prepared earlier, read in {:.2f} s, {} triangles", seconds_since(start),
                             read->prepared.scene->statistics().drawn_triangles));
        return std::move(read->prepared);
      }
      say(log, fmt::format("the prepared scene is not used: {}", read.error().message));
    }
  }
  const auto since = std::chrono::system_clock::now();
  Result<Loading> loading = load_and_build(argument, load, log);
  if (!loading) return tl::unexpected(loading.error());
  writers_.emplace_back([path, request, since, argument, capacity = capacity_bytes_, loading = *loading, log](const std::stop_token& stop) {
    // A generated scene is one for as long as no file of its name appears.
    std::vector<std::string> names = loading.sources;
    names.push_back(argument);
    Result<std::vector<SourceFile>> sources = describe_sources(names, since);
    const Clock::time_point writing = Clock::now();
    const Status status = sources ? write_file(path, {request, std::move(*sources), loading.warnings, loading.prepared}, capacity, stop)
                                  : Status(tl::unexpected(sources.error()));
    if (status) return say(log, fmt::format("prepared for the next start, written in {:.2f} s", seconds_since(writing)));
    say(log, fmt::format("not prepared for the next start: {}", status.error().message));
  });
  return std::move(loading->prepared);
}

}  // namespace farfield
