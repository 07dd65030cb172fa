// SPDX-License-Identifier: Apache-2.0
#include "client/load/load_program.h"

#include <unistd.h>

#include <cmath>
#include <ostream>

#include "client/load/load_options.h"
#include "client/load/load_report.h"
#include "client/load/server_metrics.h"
#include "common/base/complete_file.h"
#include "common/base/interrupt_watch.h"
#include "common/base/one_line.h"

namespace farfield::client {
namespace {

constexpr const char* kName = "farfield-load";
constexpr int kFailure = 1, kUsage = 2, kInterrupted = 130;
// Where nobody looks at a line that renews itself.
constexpr double kBetweenLines_s = 10;

class ProgressLine {
 public:
  ProgressLine(std::ostream& talk, bool is_quiet) : talk_(talk), is_quiet_(is_quiet) {}
  ~ProgressLine() {
    if (is_terminal_ && is_open_) talk_ << '\n';
  }
  void show(const LoadProgress& at) {
    if (is_quiet_ || (!is_terminal_ && at.seconds < next_s_)) return;
    next_s_ = at.seconds + kBetweenLines_s;
    const std::string line = fmt::format("{:.0f} s: {} clients, {} connected, {} waiting for a cell", at.seconds, at.arrived, at.streaming, at.late);
    talk_ << (is_terminal_ ? "\r\x1b[K" : "") << line << (is_terminal_ ? "" : "\n") << std::flush;
    is_open_ = true;
  }

 private:
  std::ostream& talk_;
  const bool is_quiet_;
  const bool is_terminal_ = isatty(STDERR_FILENO) != 0;
  bool is_open_ = false;
  double next_s_ = 0;
};

// Whether all are met; those that are not are told.
bool judge_all(const std::vector<Threshold>& thresholds, nlohmann::json& report, std::ostream& talk) {
  bool is_met = true;
  nlohmann::json judged = nlohmann::json::array();
  for (const Threshold& threshold : thresholds) {
    const Verdict verdict = judge(threshold, report);
    judged.push_back({{"threshold", threshold.text}, {"is_met", verdict.is_met}});
    if (verdict.is_met) continue;
    is_met = false;
    complain(talk, kName, fmt::format("threshold missed: {}: {}", threshold.text, std::isnan(verdict.measured) ? "nothing was measured" : fmt::format("it was {:.6g}", verdict.measured)));
  }
  if (!thresholds.empty()) report["thresholds"] = judged;
  return is_met;
}

Status write_report(const LoadProgramOptions& options, const nlohmann::json& report, std::ostream& out) {
  const bool is_on_stdout = options.json == "-";
  if (is_on_stdout) {
    out << report.dump(2) << '\n';
  } else {
    print_load_report(report, out);
  }
  if (!out.flush()) return fail(ErrorCode::kIo, "the report cannot be written to the output");
  if (options.json.empty() || is_on_stdout) return {};
  return write_complete_file(options.json, report.dump(2) + "\n");
}

}  // namespace

int run_load_program(int argument_count, const char* const* arguments, std::ostream& out, std::ostream& talk) {
  tl::expected<LoadProgramOptions, int> options = parse_load_options(argument_count, arguments, out, talk);
  if (!options) return options.error();
  const auto failed = [&](const Error& error) {
    complain(talk, kName, error.message);
    return error.code == ErrorCode::kInvalidArgument ? kUsage : kFailure;
  };
  if (!options->json.empty() && options->json != "-")
    if (const Status writable = check_file_can_be_written(options->json); !writable) return failed(writable.error());
  InterruptWatch interrupt;
  options->load.is_interrupted = &interrupt.is_interrupted();
  std::optional<double> planned_before;
  if (options->admin) {
    const Result<double> planned = read_metric(*options->admin, kLeafPlansMetric);
    if (!planned) return failed(planned.error());
    planned_before = *planned;
  }
  Result<LoadOutcome> outcome = tl::unexpected<Error>(Error{});
  {
    ProgressLine line(talk, options->is_quiet);
    outcome = run_load(options->load, [&](const LoadProgress& at) { line.show(at); });
  }
  if (!outcome) return failed(outcome.error());
  CellsMade made;
  if (planned_before) {
    // A server that was started anew meanwhile counts from the beginning, and one that is gone says nothing.
    if (const Result<double> planned = read_metric(*options->admin, kLeafPlansMetric))
      made = static_cast<std::uint64_t>(*planned >= *planned_before ? *planned - *planned_before : *planned);
  }
  nlohmann::json report = load_report(options->load, *outcome, made);
  const bool is_met = judge_all(options->thresholds, report, talk);
  if (const Status written = write_report(*options, report, out); !written) return failed(written.error());
  if (outcome->is_interrupted) return kInterrupted;
  return is_met ? 0 : kFailure;
}

}  // namespace farfield::client
