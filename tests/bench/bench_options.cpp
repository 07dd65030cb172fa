// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/bench_options.h"

#include <algorithm>
#include <iostream>
#include <sstream>

#include "server/app/load_arguments.h"
#include "server/app/quality_arguments.h"
#include "tests/bench/methods.h"
#include "tests/bench/sweep.h"

namespace farfield::bench {
namespace {

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> parts;
  std::stringstream in(text);
  for (std::string part; std::getline(in, part, ',');)
    if (!part.empty()) parts.push_back(part);
  return parts;
}

std::string parse_size(const std::string& text, Display& display) {
  int used = 0;
  const bool is_size = std::sscanf(text.c_str(), "%dx%d%n", &display.width, &display.height, &used) == 2 && text.size() == static_cast<std::size_t>(used);
  if (is_size && std::min(display.width, display.height) >= 16 && std::max(display.width, display.height) <= 8192) return {};
  return "--size '" + text + "': write WIDTHxHEIGHT, 16 to 8192 each";
}

}  // namespace

tl::expected<ParsedCommand, int> parse_command(int argc, const char* const* argv) {
  ParsedCommand command;
  BenchOptions& bench = command.bench;
  bench.settings.face_tiles = 0;
  CLI::App app{"Runs methods of showing a scene side by side on one trace and measures time, bytes and error against truth.\n\n"
               "Example: farfield-bench --scene pipes:1000000:1 --trace walk.txt --methods rays,farfield-cpu --json out.json", "farfield-bench"};
  BenchOptions shown = bench;
  shown.settings.face_tiles = face_tiles_for(shown.display, shown.settings.kappa);
  app.footer(describe(all_methods(shown)));
  app.set_version_flag("--version", std::string("farfield-bench 0.1.0"));
  std::string methods = "rays,geometry,geometry-culled,farfield-cpu,farfield-gl", size = "1280x720";
  std::vector<std::string> sweeps;
  double fovy = 60;
  LoadArguments load;
  app.add_option("--scene", bench.scene, "a file, or kind:triangles:seed");
  app.add_option("--trace", bench.trace, "camera path, as farfield-trace makes it");
  app.add_option("--methods", methods, "comma-separated, of those below; none: only what is swept")->capture_default_str();
  app.add_option("--sweep", sweeps, "METHOD:KNOB=a,b,c: runs METHOD once per value, lockstep; may be given again")
      ->expected(1)
      ->take_all();
  app.add_option("--size", size, "pixels, WIDTHxHEIGHT")->capture_default_str();
  app.add_option("--fovy", fovy, "vertical field of view in degrees")->check(number_between(1, 170))->capture_default_str();
  app.add_option("--frames", bench.frames, "frames compared with truth, spread evenly over the trace")->check(whole_number_between(1, 100000))->capture_default_str();
  app.add_option("--truth-samples", bench.truth_samples, "rays per pixel of truth")->check(CLI::IsMember({1, 16}))->capture_default_str();
  app.add_option("--border-pairs", bench.border_pairs,
                 "pairs of successive frames across borders of cells, and as many inside, drawn to compare the change of their errors; 0: none")
      ->check(whole_number_between(0, 1000))
      ->capture_default_str();
  app.add_option("--link", bench.link, "none, or rate=20mbit,delay=50ms,jitter=20ms,loss=0.1%")->capture_default_str();
  load.add_to(app);
  app.add_option("--threads", bench.threads, "that make tiles; 0: one per processor")->check(whole_number_between(0, 1024))->capture_default_str();
  app.add_option("--client-samples", bench.client_samples, "samples per pixel of the client; 0: 4 on a GPU, else 1")->check(CLI::IsMember({0, 1, 4}))->capture_default_str();
  add_quality_options(app, bench.settings);
  app.add_flag("!--no-realtime", bench.is_realtime_wanted, "lockstep only");
  app.add_flag("--explain", bench.explains, "print what Farfield's server skipped and why, per cell of the walk, and what that saved");
  app.add_option("--json", bench.json, "write the report here; - for standard output");
  app.add_option("--plot", bench.plot, "write frame time and bytes per second against error here, SVG");
  app.add_option("--frames-dir", bench.frames_folder, "write every method's frames and truth here as NNNN-METHOD.png");
  app.add_option("--contact-sheet", bench.contact_sheet, "write a PNG of the methods' frames above truth");
  // The measured client: farfield-bench starts itself with these.
  std::string role;
  ClientRole& client = command.client;
  app.add_option("--role", role)->group("");
  app.add_option("--endpoint", client.endpoint)->group("");
  app.add_option("--renderer", client.renderer)->group("");
  app.add_option("--mode", client.mode)->group("");
  app.add_option("--folder", client.folder)->group("");
  if (const std::optional<int> over = parse_command_line(app, argc, argv, std::cout, std::cerr)) return tl::unexpected(*over);
  const auto usage = [](const std::string& line) {
    complain(std::cerr, "farfield-bench", line);
    return tl::unexpected(2);
  };
  if (const std::string wrong = parse_size(size, bench.display); !wrong.empty()) return usage(wrong);
  bench.display.fovy_rad = fovy * 3.14159265358979323846 / 180;
  if (bench.settings.face_tiles == 0) bench.settings.face_tiles = face_tiles_for(bench.display, bench.settings.kappa);
  if (role == "client") {
    command.is_client = true;
    client.trace = bench.trace, client.frames = bench.frames, client.display = bench.display, client.samples = bench.client_samples;
    return command;
  }
  if (bench.scene.empty() || bench.trace.empty()) return usage("--scene and --trace are needed (see --help)");
  if (!role.empty()) return usage("--role: there is no '" + role + "'");
  if (methods != "none" || sweeps.empty()) bench.methods = split(methods);
  if (bench.methods.empty() && sweeps.empty()) return usage("--methods: name at least one (see --help)");
  const std::vector<Method> known = all_methods(bench);
  for (const std::string& method : bench.methods)
    if (!find_method(known, method))
      return usage("--methods: there is no '" + method + "' (see --help)");
  for (const std::string& text : sweeps) {
    const Result<Sweep> sweep = parse_sweep(text, known);
    if (!sweep) return usage("--sweep: " + sweep.error().message);
    bench.sweeps.push_back(*sweep);
  }
  const Result<LinkModel> link = parse_link_model(bench.link);
  if (!link) return usage("--link: " + link.error().message);
  bench.link_model = *link;
  bench.load = load.options();
  bench.prints_json = bench.json == "-";
  return command;
}

}  // namespace farfield::bench
