// SPDX-License-Identifier: Apache-2.0
// farfield-bake: fills a store for paths or a region ahead of time. Data on stdout, talk on stderr.
#pragma once

#include <atomic>
#include <filesystem>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "common/impostor/settings.h"
#include "common/math/box.h"
#include "server/app/baker.h"
#include "server/app/open_stores.h"
#include "server/model/load_model.h"

namespace farfield {

struct BakeOptions {
  std::string scene;                            // as farfield-server takes it: what it is called decides nothing here
  StoreOptions stores;                          // at least one
  std::vector<std::filesystem::path> traces;    // files, and folders of *.trace
  std::optional<Box> region;                    // world
  int threads = 0;                              // that cast; 0: one per processor
  LoadOptions load;
  ImpostorSettings settings;
  bool is_json = false;
};

/// Returns: whether it was stopped before its end; what was baked until then is stored. Errors: what kept it from baking, or a store that
/// could not be written.
Result<bool> run_bake(const BakeOptions& options, const std::atomic<bool>& is_stopped, std::ostream& out, std::ostream& talk);

/// {"format":"farfield-bake/1", …}: documented in docs/store.md.
std::string bake_json(const BakeProgress& progress, bool is_complete);

/// The whole program. Returns: 0 done, 1 failed (one line on stderr), 2 wrong usage, 130 interrupted.
int run_bake_tool(int argument_count, const char* const* arguments);

}  // namespace farfield
