// SPDX-License-Identifier: Apache-2.0
#include "server/model/import_file.h"

#include <sys/prctl.h>
#include <sys/resource.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>
#include <optional>

#include "server/model/assimp_reader.h"
#include "server/model/city_json_reader.h"
#include "server/model/clean_model.h"
#include "server/model/file_claims.h"
#include "server/model/model_stream.h"
#include "server/model/obj_reader.h"
#include "server/model/text_lines.h"

namespace farfield {
namespace {

// Sanitizers reserve terabytes of address space for themselves.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kLimitsAddressSpace = false;
#else
constexpr bool kLimitsAddressSpace = true;
#endif

bool set_limit(__rlimit_resource resource, std::uint64_t value) {
  const rlimit limit{value, value};
  return setrlimit(resource, &limit) == 0;
}

Result<Model> read_by_format(const std::filesystem::path& path, ModelFormat format) {
  switch (format) {
    case ModelFormat::kObj: return read_obj(path);
    case ModelFormat::kCityJson: return read_city_json(path);
    default: return read_with_assimp(path, format);
  }
}

Status import_and_write(const std::filesystem::path& path, int output) {
  const Result<Model> model = import_file(path);
  if (!model) return tl::unexpected(model.error());
  return write_model_stream(*model, output);
}

}  // namespace

Status limit_import_process(const ImportLimits& limits) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  std::signal(SIGXFSZ, SIG_IGN);  // then a stream beyond the limit is an error of write(), not a signal
  if (!set_limit(RLIMIT_CORE, 0) || (kLimitsAddressSpace && !set_limit(RLIMIT_AS, limits.memory_bytes)) ||
      !set_limit(RLIMIT_FSIZE, limits.memory_bytes) || !set_limit(RLIMIT_CPU, limits.cpu_seconds)) {
    return fail(ErrorCode::kInternal, "the import process cannot be limited: {}", std::strerror(errno));
  }
  return {};
}

Result<Model> import_file(const std::filesystem::path& path) {
  const Result<ModelFormat> format = find_model_format(path);
  if (!format) return tl::unexpected(format.error());
  const Result<FileClaims> claims = check_file_claims(path, *format);
  if (!claims) return tl::unexpected(claims.error());
  Result<Model> model = read_by_format(path, *format);
  if (!model) return model;
  model->sources.insert(model->sources.begin(), path.string());
  std::size_t stored = 0;
  for (const Mesh& mesh : model->meshes) stored += mesh.indices.size() / 3;
  if (claims->stored_triangles.value_or(0) > stored) {
    model->warnings.push_back(
        fmt::format("triangles of the file that its importer dropped, naming missing vertices: {}",
                    *claims->stored_triangles - stored));
  }
  if (*format == ModelFormat::kCityJson) {
    for (Mesh& mesh : model->meshes) weld_vertices(mesh);  // its surfaces do not share vertices when read
  }
  return model;
}

int run_import_program(int argument_count, char** arguments) {
  std::optional<int> output;
  std::optional<std::uint64_t> memory_bytes, cpu_seconds;
  if (argument_count == 5) {
    output = parse_number<int>(arguments[2]);
    memory_bytes = parse_number<std::uint64_t>(arguments[3]);
    cpu_seconds = parse_number<std::uint64_t>(arguments[4]);
  }
  if (!output || !memory_bytes || !cpu_seconds) {
    std::fprintf(stderr,
                 "usage: farfield-import FILE OUTPUT_DESCRIPTOR MEMORY_BYTES CPU_SECONDS\n"
                 "Started by Farfield's programs to read a model file at arm's length; "
                 "'farfield-scene info FILE' is what people run.\n");
    return 2;
  }
  Status status = limit_import_process({*memory_bytes, *cpu_seconds});
  try {
    if (status) status = import_and_write(arguments[1], *output);
  } catch (const std::bad_alloc&) {
    status = fail(ErrorCode::kLimitExceeded, "it needs more memory than the import process may use");
  } catch (const std::exception& exception) {
    status = fail(ErrorCode::kBadData, "the importer gave up: {}", exception.what());
  }
  if (status) return 0;
  std::fprintf(stderr, "%s\n", status.error().message.c_str());
  return 1;
}

}  // namespace farfield
