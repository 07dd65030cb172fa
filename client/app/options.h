// SPDX-License-Identifier: Apache-2.0
// The command line of farfield-client.
#pragma once

#include <cstddef>
#include <filesystem>
#include <iosfwd>
#include <string>
#include <tl/expected.hpp>

#include "common/math/camera.h"
#include "common/net/endpoint.h"
#include "common/net/link_model.h"
#include "common/net/tls.h"

namespace farfield::client {

inline constexpr int kExitFailure = 1;
inline constexpr int kExitUsage = 2;
inline constexpr int kExitInterrupted = 130;

enum class RendererChoice { kAuto, kCpu, kGl };

struct ProgramOptions {
  Endpoint server;
  std::shared_ptr<const TlsClient> tls;  // null: a plain connection
  std::string access_token;
  std::string scene;
  LinkModel link;                        // modelled in this process, between client and server
  bool is_window = false;                // else headless
  std::filesystem::path trace;           // empty: stand at the scene's start
  std::filesystem::path frames_dir;      // empty: no images
  std::filesystem::path record;          // empty: no trace of the walk is written
  std::size_t frames = 0;                // 0: the trace's own number (lockstep), or until it ends
  bool is_lockstep = false;              // every frame waits for its complete leaf set
  double frames_per_second = 60;         // real time: no more than this; 0: as many as it can
  RendererChoice renderer = RendererChoice::kAuto;
  int samples_per_pixel = 0;  // 0: the renderer's choice
  double fade_s = 0.25;       // from one leaf set to the next
  Display display;
  std::size_t memory_bytes = std::size_t{448} << 20;
  double timeout_s = 60;                 // for the welcome, and for a leaf set in lockstep
  bool is_json = false;
  bool is_quiet = false;
};

/// The exit code to end with at once: 0 after --help and --version, 2 for what cannot be meant; everything has been
/// said on `out` and `talk` then. Flags win over FARFIELD_* environment variables.
tl::expected<ProgramOptions, int> parse_options(int argument_count, const char* const* arguments, std::ostream& out,
                                                std::ostream& talk);

}  // namespace farfield::client
