// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/bench_program.h"

#include <algorithm>
#include <iostream>

#include "common/base/complete_file.h"
#include "tests/bench/farfield_method.h"
#include "tests/bench/reference_methods.h"
#include "tests/bench/report.h"

namespace farfield::bench {
namespace {

bool wants(const BenchOptions& options, const char* method) {
  return std::find(options.methods.begin(), options.methods.end(), method) != options.methods.end();
}

// Farfield first: what it holds in memory must not include what the baselines need.
Result<std::vector<MethodResult>> run_methods(const World& world) {
  std::vector<MethodResult> results;
  for (const std::string renderer : {"cpu", "gl"}) {
    if (!wants(world.options, ("farfield-" + renderer).c_str())) continue;
    Result<MethodResult> result = run_farfield(world, renderer);
    if (!result) return tl::unexpected(result.error());
    results.push_back(std::move(*result));
  }
  if (wants(world.options, "rays")) {
    Result<MethodResult> result = run_rays(world);
    if (!result) return tl::unexpected(result.error());
    results.push_back(std::move(*result));
  }
  const bool full = wants(world.options, "geometry"), culled = wants(world.options, "geometry-culled");
  if (full || culled) {
    Result<std::vector<MethodResult>> both = run_geometry(world, full, culled);
    if (!both) return tl::unexpected(both.error());
    for (MethodResult& result : *both) results.push_back(std::move(result));
  }
  const auto order = [&](const MethodResult& m) {
    return std::find(world.options.methods.begin(), world.options.methods.end(), m.name) - world.options.methods.begin();
  };
  std::sort(results.begin(), results.end(), [&](const MethodResult& a, const MethodResult& b) { return order(a) < order(b); });
  return results;
}

}  // namespace

Status run_bench(const BenchOptions& options) {
  // Said before the measurements, not after them.
  for (const std::filesystem::path& file : {options.prints_json ? std::filesystem::path() : options.json, options.plot, options.contact_sheet}) {
    if (file.empty()) continue;
    if (Status status = check_file_can_be_written(file); !status) return status;
  }
  if (std::error_code error; !options.frames_folder.empty()) {
    std::filesystem::create_directories(options.frames_folder, error);
    if (error) return fail(ErrorCode::kIo, "--frames-dir {}: cannot be made ({})", options.frames_folder.string(), error.message());
  }
  const Result<World> world = make_world(options);
  if (!world) return tl::unexpected(world.error());
  const Result<std::vector<MethodResult>> methods = run_methods(*world);
  if (!methods) return tl::unexpected(methods.error());
  const nlohmann::json json = to_json(*world, *methods);
  if (options.prints_json) {
    std::cout << json.dump(2) << '\n';
  } else {
    print_table(*methods, std::cout);
    if (!options.json.empty()) {
      if (Status status = write_complete_file(options.json, json.dump(2) + '\n'); !status) return status;
    }
  }
  if (!std::cout.flush()) return fail(ErrorCode::kIo, "the report cannot be written to the output");
  if (!options.plot.empty())
    if (Status status = write_plot(options.plot, *methods); !status) return status;
  if (!options.frames_folder.empty())
    if (Status status = write_frames(options.frames_folder, *world, *methods); !status) return status;
  if (!options.contact_sheet.empty())
    if (Status status = write_contact_sheet(options.contact_sheet, *world, *methods); !status) return status;
  return {};
}

}  // namespace farfield::bench
