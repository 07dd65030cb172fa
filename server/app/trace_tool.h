// SPDX-License-Identifier: Apache-2.0
// farfield-trace: makes camera traces through scenes and shows what a trace is. Data on stdout, talk on stderr.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>

#include "server/app/walk_path.h"
#include "server/model/load_model.h"

namespace farfield {

struct TraceGenerateOptions {
  std::string scene;  // a file, or KIND:TRIANGLES:SEED
  LoadOptions load;
  TraceOptions trace;
  std::filesystem::path output;  // a file; of several traces the folder, made if it is not there
  std::size_t count = 1;
  bool is_json = false;
};

struct TraceShowOptions {
  std::filesystem::path file;
  std::string scene;  // empty: none
  LoadOptions load;
  std::filesystem::path svg, png;  // empty: none
  bool is_json = false;
};

/// Writes the trace, or several as SEED.trace, with the seeds from trace.seed on that have a path, and reports to `out`; `talk` gets one line if a walk had to become a flight.
/// Errors: as load_model(), Scene::build(), generate_trace(), write_trace().
Status run_trace_generate(const TraceGenerateOptions& options, std::ostream& out, std::ostream& talk);

/// Reports a trace to `out` in numbers and drawn from above. Errors: as read_trace() and load_model(); kIo.
Status run_trace_show(const TraceShowOptions& options, std::ostream& out);

/// The whole program. Returns: 0 done, 1 failed (one line on stderr), 2 wrong usage.
int run_trace_tool(int argument_count, const char* const* arguments);

}  // namespace farfield
