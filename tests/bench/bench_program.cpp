// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/bench_program.h"

#include <algorithm>
#include <iostream>
#include <span>

#include "common/base/complete_file.h"
#include "tests/bench/explain.h"
#include "tests/bench/methods.h"
#include "tests/bench/report.h"
#include "tests/bench/sweep.h"

namespace farfield::bench {
namespace {

Result<MethodResult> run(const Method& method, std::span<const KnobSetting> settings, const World& world) {
  std::cerr << method.name << '\n';
  Result<MethodResult> result = method.run(world, values_of(method, settings));
  if (!result) return fail_within(method.name, result.error());
  result->name = method.name;
  return result;
}

// In the order asked for, but run in the order their memory figures need.
Result<std::vector<MethodResult>> run_methods(const World& world, std::span<const Method> methods) {
  const std::vector<std::string>& names = world.options.methods;
  std::vector<MethodResult> results(names.size());
  for (const bool is_first : {true, false})
    for (std::size_t i = 0; i < names.size(); ++i) {
      const Method& method = *find_method(methods, names[i]);
      if (method.runs_first != is_first) continue;
      Result<MethodResult> result = run(method, {}, world);
      if (!result) return tl::unexpected(result.error());
      results[i] = std::move(*result);
    }
  return results;
}

bool has_cells(const BenchOptions& options, std::span<const Method> methods) {
  const auto has = [&](const std::string& name) { return find_method(methods, name)->has_cells; };
  return std::any_of(options.methods.begin(), options.methods.end(), has) ||
         std::any_of(options.sweeps.begin(), options.sweeps.end(), [&](const Sweep& sweep) { return has(sweep.method); });
}

// Lockstep only: what a curve shows is measured there.
Result<std::vector<Curve>> run_sweeps(World& world, std::span<const Method> methods) {
  world.options.is_realtime_wanted = world.options.explains = false;
  world.border = nullptr;
  std::vector<Curve> curves;
  for (const Sweep& sweep : world.options.sweeps) {
    Result<Curve> curve = run_sweep(world, methods, sweep);
    if (!curve) return tl::unexpected(curve.error());
    curves.push_back(std::move(*curve));
  }
  return curves;
}

}  // namespace

Status run_bench(const BenchOptions& options) {
  // Said before the measurements, not after them.
  for (const std::filesystem::path& file :
       {options.prints_json ? std::filesystem::path() : options.json, options.plot, options.contact_sheet}) {
    if (file.empty()) continue;
    if (Status status = check_file_can_be_written(file); !status) return status;
  }
  if (std::error_code error; !options.frames_folder.empty()) {
    std::filesystem::create_directories(options.frames_folder, error);
    if (error) return fail(ErrorCode::kIo, "--frames-dir {}: cannot be made ({})", options.frames_folder.string(), error.message());
  }
  const std::vector<Method> known = all_methods(options);
  Result<World> world = make_world(options, has_cells(options, known));
  if (!world) return tl::unexpected(world.error());
  const Result<std::vector<MethodResult>> methods = run_methods(*world, known);
  if (!methods) return tl::unexpected(methods.error());
  const Result<std::vector<Curve>> curves = run_sweeps(*world, known);
  if (!curves) return tl::unexpected(curves.error());
  const nlohmann::json json = to_json(*world, *methods, *curves);
  if (options.prints_json) {
    std::cout << json.dump(2) << '\n';
  } else {
    print_table(*methods, std::cout);
    print_dominance(*methods, *curves, std::cout);
    for (const MethodResult& method : *methods) print_explanation(method, std::cout);
    if (!options.json.empty()) {
      if (Status status = write_complete_file(options.json, json.dump(2) + '\n'); !status) return status;
    }
  }
  if (!std::cout.flush()) return fail(ErrorCode::kIo, "the report cannot be written to the output");
  if (!options.plot.empty())
    if (Status status = write_plot(options.plot, *methods, *curves); !status) return status;
  if (!options.frames_folder.empty())
    if (Status status = write_frames(options.frames_folder, *world, *methods); !status) return status;
  if (!options.contact_sheet.empty())
    if (Status status = write_contact_sheet(options.contact_sheet, *world, *methods); !status) return status;
  return {};
}

}  // namespace farfield::bench
