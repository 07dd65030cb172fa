// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/bench_options.h"

#include <CLI/CLI.hpp>
#include <iostream>
#include <sstream>

namespace farfield::bench {
namespace {

const std::vector<std::string> kMethods{"rays", "geometry", "geometry-culled", "farfield-cpu", "farfield-gl"};

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> parts;
  std::stringstream in(text);
  for (std::string part; std::getline(in, part, ',');)
    if (!part.empty()) parts.push_back(part);
  return parts;
}

std::string parse_size(const std::string& text, Display& display) {
  if (std::sscanf(text.c_str(), "%dx%d", &display.width, &display.height) == 2 && display.width >= 16 && display.height >= 16 &&
      display.width <= 8192 && display.height <= 8192)
    return {};
  return "--size '" + text + "': write WIDTHxHEIGHT, 16 to 8192 each";
}

}  // namespace

tl::expected<ParsedCommand, int> parse_command(int argc, const char* const* argv) {
  ParsedCommand command;
  BenchOptions& bench = command.bench;
  bench.settings.face_tiles = 0;
  CLI::App app{"Runs methods of showing a scene side by side on one trace and measures time, bytes and error against truth.\n\n"
               "Example: farfield-bench --scene pipes:1000000:1 --trace walk.txt --methods rays,farfield-cpu --json out.json"};
  app.set_version_flag("--version", std::string("farfield-bench 0.1.0"));
  std::string methods = "rays,geometry,geometry-culled,farfield-cpu,farfield-gl", size = "1280x720", shift;
  double fovy = 60;
  app.add_option("--scene", bench.scene, "a file, or kind:triangles:seed");
  app.add_option("--trace", bench.trace, "camera path, as farfield-trace makes it");
  app.add_option("--methods", methods, "of rays, geometry, geometry-culled, farfield-cpu, farfield-gl")->capture_default_str();
  app.add_option("--size", size, "pixels, WIDTHxHEIGHT")->capture_default_str();
  app.add_option("--fovy", fovy, "vertical field of view in degrees")->check(CLI::Range(1.0, 170.0))->capture_default_str();
  app.add_option("--frames", bench.frames, "frames compared with truth, spread evenly over the trace")->check(CLI::Range(1, 100000))->capture_default_str();
  app.add_option("--truth-samples", bench.truth_samples, "rays per pixel of truth")->check(CLI::IsMember({1, 16}))->capture_default_str();
  app.add_option("--link", bench.link, "none, or rate=20mbit,delay=50ms,jitter=20ms,loss=0.1%")->capture_default_str();
  app.add_option("--shift", shift, "X,Y,Z metres added to every world position");
  app.add_option("--units", bench.load.metres_per_unit, "metres per unit of the file");
  app.add_option("--up", bench.load.up, "x, y or z");
  app.add_option("--threads", bench.threads, "that make tiles; 0: one per processor")->capture_default_str();
  app.add_option("--client-samples", bench.client_samples, "samples per pixel of the client")->check(CLI::IsMember({1, 4}))->capture_default_str();
  app.add_option("--tau", bench.settings.tau_px, "guaranteed warp error of coded disparity, pixels")->capture_default_str();
  app.add_option("--face-tiles", bench.settings.face_tiles, "tiles along a face's edge: the sample rate; 0: what the display needs")->check(CLI::Range(0, 64));
  app.add_option("--quality", bench.settings.jpeg_quality, "JPEG quality of tiles")->check(CLI::Range(1, 100))->capture_default_str();
  app.add_option("--delta-views", bench.settings.delta_views, "at most, per cell")->check(CLI::Range(0, 32))->capture_default_str();
  app.add_flag("!--no-realtime", bench.is_realtime_wanted, "lockstep only");
  app.add_option("--json", bench.json, "write the report here; - for standard output");
  app.add_option("--plot", bench.plot, "write frame time against error here, SVG");
  app.add_option("--contact-sheet", bench.contact_sheet, "write a PNG of the methods' frames above truth");
  // The measured client: farfield-bench starts itself with these.
  std::string role;
  ClientRole& client = command.client;
  app.add_option("--role", role)->group("");
  app.add_option("--endpoint", client.endpoint)->group("");
  app.add_option("--renderer", client.renderer)->group("");
  app.add_option("--mode", client.mode)->group("");
  app.add_option("--folder", client.folder)->group("");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const int code = app.exit(error);
    return tl::unexpected(code == 0 ? 0 : 2);
  }
  const auto usage = [](const std::string& line) {
    std::cerr << "farfield-bench: " << line << '\n';
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
  bench.methods = split(methods);
  for (const std::string& method : bench.methods)
    if (std::find(kMethods.begin(), kMethods.end(), method) == kMethods.end())
      return usage("--methods: there is no '" + method + "' (see --help)");
  const Result<LinkModel> link = parse_link_model(bench.link);
  if (!link) return usage("--link: " + link.error().message);
  bench.link_model = *link;
  if (!shift.empty() && std::sscanf(shift.c_str(), "%lf,%lf,%lf", &bench.load.shift.x, &bench.load.shift.y, &bench.load.shift.z) != 3)
    return usage("--shift '" + shift + "': write X,Y,Z in metres");
  bench.prints_json = bench.json == "-";
  return command;
}

}  // namespace farfield::bench
