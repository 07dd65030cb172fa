// SPDX-License-Identifier: Apache-2.0
#include "client/app/options.h"

#include <charconv>
#include <map>
#include <numbers>
#include <ostream>
#include <string_view>

#include "client/session/server_arguments.h"
#include "common/base/byte_size.h"
#include "common/base/command_line.h"
#include "common/net/message_type.h"

namespace farfield::client {
namespace {

constexpr const char* kFooter =
    "Examples:\n"
    "  farfield-client --connect scenes.example.org:7400 --scene clinic\n"
    "      Walk through a scene in a window.\n"
    "  farfield-client --connect farfields://scenes.example.org --token-file ~/.config/farfield/token\n"
    "      The same through TLS, with the token that the server's owner gave out.\n"
    "  farfield-client --connect :7400 --headless --trace walk.trace --frames-dir out --json\n"
    "      Replay a recorded walk in real time without a screen; images into out/, figures to stdout.\n"
    "  farfield-client --connect :7400 --headless --trace walk.trace --lockstep --frames 60\n"
    "      The same walk as 60 frames, each waiting for its complete leaf set.\n"
    "  farfield-client --connect :7400 --headless --trace walk.trace --link rate=20mbit,delay=40ms\n"
    "      Over a slow link, modelled in this process.\n"
    "\n"
    "Exit status: 0 success, 1 failure, 2 wrong usage, 130 interrupted.";

constexpr int kSmallestEdgePx = 16;
constexpr int kLargestEdgePx = 8192;
constexpr std::size_t kLeastMemory = std::size_t{1} << 20;

/// "1280x720".
std::string parse_size(const std::string& text, Display& display) {
  int width = 0, height = 0;
  const char* const end = text.data() + text.size();
  const auto first = std::from_chars(text.data(), end, width);
  const bool has_cross = first.ec == std::errc() && first.ptr != end && (*first.ptr == 'x' || *first.ptr == 'X');
  const auto second = has_cross ? std::from_chars(first.ptr + 1, end, height) : first;
  const auto is_edge = [](int edge) { return edge >= kSmallestEdgePx && edge <= kLargestEdgePx; };
  if (!has_cross || second.ec != std::errc() || second.ptr != end || !is_edge(width) || !is_edge(height)) {
    return text + " is no image size: write WIDTHxHEIGHT, as in 1280x720, each 16 to 8192";
  }
  display.width = width;
  display.height = height;
  return {};
}

/// A CLI11 check that stores what it parsed; CLI11 prefixes the message with the option's name.
template <class Parse>
auto storing(Parse parse) {
  return [parse](const std::string& text) -> std::string { return parse(text); };
}

std::string version_line() {
#ifdef NDEBUG
  constexpr const char* kBuild = "release";
#else
  constexpr const char* kBuild = "debug";
#endif
  return fmt::format("farfield-client {} ({} build, protocol {} to {}, g++ {})", FARFIELD_VERSION, kBuild,
                     kProtocolVersionMin, kProtocolVersionMax, __VERSION__);
}

}  // namespace

tl::expected<ProgramOptions, int> parse_options(int argument_count, const char* const* arguments, std::ostream& out,
                                                std::ostream& talk) {
  ProgramOptions options;
  CLI::App app{"Walk through 3D models far too big for this machine.", "farfield-client"};
  app.footer(kFooter);
  app.set_version_flag("--version", version_line());

  ServerArguments server;
  std::string size, link, record, trace, frames_dir, memory;
  double fovy_deg = 60;
  bool is_headless = false;
  server.add_to(app);
  app.add_option("--scene", options.scene, "Scene in the server's catalogue; default: its first")->envname("FARFIELD_SCENE");
  app.add_option("--link", link, "Model a slow link: rate=20mbit,delay=40ms,jitter=5ms,loss=0.1%");
  app.add_flag("--window", options.is_window, "Show a window (default)");
  CLI::Option* headless = app.add_flag("--headless", is_headless, "Draw without a screen");
  headless->excludes("--window");
  app.add_option("--trace", trace, "Replay a recorded camera path")->check(CLI::ExistingFile);
  app.add_option("--frames-dir", frames_dir, "Write every frame as PNG into this folder")->needs(headless);
  app.add_option("--frames", options.frames, "Frames to draw; in lockstep spread evenly over the trace; 0: all")->check(whole_number_between(0, 10'000'000));
  app.add_flag("--lockstep", options.is_lockstep, "Every frame waits for its complete leaf set")->needs(headless);
  app.add_option("--fps", options.frames_per_second, "At most this many frames per second; 0: no bound")
      ->check(number_between(0, 1000))
      ->capture_default_str();
  app.add_option("--record", record, "Write the walk as a trace to this file");
  const std::map<std::string, RendererChoice> renderers{
      {"auto", RendererChoice::kAuto}, {"cpu", RendererChoice::kCpu}, {"gl", RendererChoice::kGl}};
  app.add_option("--renderer", options.renderer, "Impostors on the cpu or by gl; auto: gl where there is a GPU")
      ->transform(CLI::CheckedTransformer(renderers))
      ->type_name("auto|cpu|gl")
      ->envname("FARFIELD_RENDERER")
      ->default_str("auto");
  app.add_option("--samples", options.samples_per_pixel, "Samples per pixel; 0: 4 on a GPU, else 1")->check(CLI::IsMember({0, 1, 4}))->capture_default_str();
  app.add_option("--fade", options.fade_s, "Seconds in which one cell's impostors give way to the next one's; frames take twice as long meanwhile; 0: at once")
      ->check(number_between(0, 10))
      ->capture_default_str();
  app.add_option("--size", size, "Image size, WIDTHxHEIGHT")
      ->check(storing([&](const std::string& text) { return parse_size(text, options.display); }))
      ->default_str("1280x720");
  app.add_option("--fovy", fovy_deg, "Vertical field of view in degrees")->check(number_between(1, 170))->capture_default_str();
  app.add_option("--memory", memory, "Bound on decoded geometry and images in main memory, as in 320MiB")
      ->envname("FARFIELD_MEMORY")
      ->default_str("448MiB");
  app.add_option("--timeout", options.timeout_s, "Seconds to wait for the server, and in lockstep for a leaf set")
      ->check(number_between(0.1, 86400))
      ->capture_default_str();
  app.add_flag("--json", options.is_json, "Figures as JSON on stdout");
  app.add_flag("-q,--quiet", options.is_quiet, "No talk on stderr but errors");
  if (const std::optional<int> over = parse_command_line(app, argument_count, arguments, out, talk)) return tl::unexpected(*over);

  options.is_window = !is_headless;
  options.display.fovy_rad = fovy_deg * std::numbers::pi / 180.0;
  options.trace = trace;
  options.frames_dir = frames_dir;
  options.record = record;
  const Result<ServerAccess> access = server.access();
  const Result<LinkModel> model = link.empty() ? Result<LinkModel>(LinkModel{}) : parse_link_model(link);
  if (!access || !model) {
    complain(talk, app.get_name(), access ? "--link: " + model.error().message : access.error().message);
    return tl::unexpected(kExitUsage);
  }
  if (!memory.empty()) {
    const Result<std::size_t> bytes = parse_byte_size(memory);
    if (!bytes) {
      complain(talk, app.get_name(), "--memory: " + bytes.error().message);
      return tl::unexpected(kExitUsage);
    }
    options.memory_bytes = *bytes;
  }
  if (options.memory_bytes < kLeastMemory) {
    complain(talk, app.get_name(), fmt::format("--memory: {} bytes hold nothing; give at least 1MiB", options.memory_bytes));
    return tl::unexpected(kExitUsage);
  }
  options.server = access->endpoint;
  options.tls = access->tls;
  options.access_token = access->token;
  options.link = *model;
  return options;
}

}  // namespace farfield::client
