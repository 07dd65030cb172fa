// SPDX-License-Identifier: Apache-2.0
#include "client/load/load_options.h"

#include <charconv>
#include <ostream>

#include "client/session/server_arguments.h"
#include "common/base/command_line.h"

namespace farfield::client {
namespace {

constexpr const char* kFooter =
    "Examples:\n"
    "  farfield-load --connect :7400 --clients 200 --arrival 20/s --seconds 60 --walk trace:walks/\n"
    "      Two hundred viewers, twenty more each second, on the recorded paths in walks/.\n"
    "  farfield-load --clients 50 --walk random --speed 1.4 --link rate=20mbit,delay=50ms --threshold 'cell_ready_p95<250ms' --json load.json\n"
    "      Over a slow link for each; exit status 1 if a twentieth of the cells take longer.\n"
    "\n"
    "Times count from when something was due: a viewer's arrival, or the moment the viewer entered a cell.\n"
    "Exit status: 0 done and all thresholds met, 1 failed or missed, 2 wrong usage, 130 interrupted.";

// Decoding costs a simulated client a hundred times what receiving costs; the server sees no difference.
constexpr std::size_t kUndecodedStore = std::size_t{448} << 20;

struct Raw {
  ServerArguments server;
  std::string admin, arrival, walk = "random", link;
  std::vector<std::string> thresholds;
  bool decodes = false;
};

void add_options(CLI::App& app, Raw& raw, LoadProgramOptions& options) {
  LoadOptions& load = options.load;
  raw.server.add_to(app);
  app.add_option("--scene", load.client.scene, "Scene in the server's catalogue; default: its first")->envname("FARFIELD_SCENE");
  app.add_option("--clients", load.clients, "Viewers")->check(whole_number_between(1, 100'000))->capture_default_str();
  app.add_option("--arrival", raw.arrival, "New viewers per time, as 20/s or 90/min (default: all at once)");
  app.add_option("--seconds", load.seconds, "From the first arrival to the end")->check(number_between(0.1, 1e6))->capture_default_str();
  app.add_option("--walk", raw.walk, "random, trace:FILE, trace:FOLDER (of *.trace), herd, herd:FILE")->capture_default_str();
  app.add_option("--speed", load.walk.speed_m_s, "Metres per second (default: recorded paths as they were, random ones 1.4)")->check(number_between(0.01, 1000));
  app.add_option("--seed", load.walk.seed, "Of random walks")->capture_default_str();
  app.add_option("--fps", load.frames_per_second, "Frames per second of a viewer: how finely times are told")->check(number_between(1, 1000))->capture_default_str();
  app.add_option("--link", raw.link, "Model a slow link for each: rate=20mbit,delay=40ms,jitter=5ms,loss=0.1%,cut=30s (mean)");
  app.add_flag("--decode", raw.decodes, "Decode what arrives, as a client with a screen does");
  app.add_option("--threshold", raw.thresholds, "FIGURE<VALUE, as in cell_ready_p95<250ms, late_share<1%, errors<1; repeatable; a missed one is exit status 1")
      ->allow_extra_args(false);
  app.add_option("--admin", raw.admin, "The server's admin HOST:PORT: to tell how many cells it made");
  app.add_option("--json", options.json, "Write the report here as JSON; - for standard output, instead of text");
  app.add_flag("-q,--quiet", options.is_quiet, "No progress");
}

Status fill(const Raw& raw, LoadProgramOptions& options) {
  LoadOptions& load = options.load;
  Result<ServerAccess> access = raw.server.access();
  if (!access) return tl::unexpected(access.error());
  load.client.server = access->endpoint;
  load.client.tls = std::move(access->tls);
  load.client.access_token = std::move(access->token);
  if (!raw.admin.empty()) {
    const Result<Endpoint> admin = parse_endpoint(raw.admin);
    if (!admin) return fail_within("--admin", admin.error());
    options.admin = *admin;
  }
  if (!raw.arrival.empty()) {
    const Result<double> arrival = parse_arrival(raw.arrival);
    if (!arrival) return fail_within("--arrival", arrival.error());
    load.arrivals_per_s = *arrival;
  }
  Result<WalkOptions> walk = parse_walk(raw.walk);
  if (!walk) return fail_within("--walk", walk.error());
  load.walk.kind = walk->kind, load.walk.traces = walk->traces;
  if (!raw.link.empty()) {
    const Result<LinkModel> link = parse_link_model(raw.link);
    if (!link) return fail_within("--link", link.error());
    load.link = *link;
  }
  for (const std::string& text : raw.thresholds) {
    Result<Threshold> threshold = parse_threshold(text);
    if (!threshold) return fail_within("--threshold", threshold.error());
    options.thresholds.push_back(std::move(*threshold));
  }
  load.client.program = "farfield-load " FARFIELD_VERSION;
  load.client.decode_threads = 1;  // with --decode
  load.client.form = raw.decodes ? DecodeForm::kSplats : DecodeForm::kNone;
  load.client.store_bytes = kUndecodedStore;
  return {};
}

}  // namespace

Result<double> parse_arrival(std::string_view text) {
  double count = 0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, count);
  const std::string_view unit(rest, static_cast<std::size_t>(end - rest));
  const double per_s = unit == "/min" ? count / 60 : unit.empty() || unit == "/s" ? count : 0;
  if (error != std::errc{} || !(per_s > 0) || per_s > 1e5) return fail(ErrorCode::kInvalidArgument, "'{}' is no rate of arrivals: write 20/s or 90/min", text);
  return per_s;
}

tl::expected<LoadProgramOptions, int> parse_load_options(int argument_count, const char* const* arguments, std::ostream& out, std::ostream& talk) {
  CLI::App app{"Walk many simulated viewers through a Farfield server, and tell what they waited for.", "farfield-load"};
  app.footer(kFooter);
  app.set_version_flag("--version", "farfield-load " FARFIELD_VERSION);
  Raw raw;
  LoadProgramOptions options;
  add_options(app, raw, options);
  if (const std::optional<int> over = parse_command_line(app, argument_count, arguments, out, talk)) return tl::unexpected(*over);
  if (const Status filled = fill(raw, options); !filled) {
    constexpr int kUsage = 2;
    complain(talk, app.get_name(), filled.error().message);
    return tl::unexpected(kUsage);
  }
  return options;
}

}  // namespace farfield::client
