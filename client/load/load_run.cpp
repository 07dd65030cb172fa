// SPDX-License-Identifier: Apache-2.0
#include "client/load/load_run.h"

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>
#include <thread>

#include "common/net/link_proxy.h"

namespace farfield::client {
namespace {

using Clock = std::chrono::steady_clock;

// From a move to the look that follows: a client's threads hand a leaf set that is there over in less.
constexpr double kGlance_s = 0.005;

double cpu_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) { return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec); };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

class LoadRun {
 public:
  LoadRun(const LoadOptions& options, const WalkPlan& plan, ClientOptions client) : options_(options), plan_(plan), client_(std::move(client)) {}

  LoadOutcome run(const std::function<void(const LoadProgress&)>& progress) {
    const double interval_s = 1 / options_.frames_per_second;
    double told_s = 0;
    for (double due_s = 0; due_s < options_.seconds && !is_interrupted(); due_s = next_due(due_s, interval_s)) {
      sleep_until(due_s);
      outcome_.own_lag.add(now() - due_s);
      admit(due_s);
      for (Walker& walker : walkers_) walker.move(due_s, now());
      sleep_until(due_s + kGlance_s);
      for (Walker& walker : walkers_) walker.look(due_s, now());
      if (progress && due_s - told_s >= 1) told_s = due_s, progress(standing(due_s));
    }
    return finish();
  }

 private:
  void sleep_until(double seconds) const {
    std::this_thread::sleep_until(start_ + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds)));
  }
  double now() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }
  bool is_interrupted() const { return options_.is_interrupted && *options_.is_interrupted; }
  // The next frame's time; frames whose time has passed are left out, as a client that cannot keep up leaves them out.
  double next_due(double due_s, double interval_s) const {
    return due_s + interval_s * std::max(1.0, std::floor((now() - due_s) / interval_s));
  }
  double arrival_of(std::size_t index) const { return options_.arrivals_per_s > 0 ? static_cast<double>(index) / options_.arrivals_per_s : 0; }

  void admit(double due_s) {
    while (walkers_.size() < options_.clients && arrival_of(walkers_.size()) <= due_s) {
      const std::size_t index = walkers_.size();
      walkers_.emplace_back(client_, plan_, index, arrival_of(index)).start();
    }
  }

  LoadProgress standing(double seconds) const {
    const auto count = [&](auto holds) { return static_cast<std::size_t>(std::count_if(walkers_.begin(), walkers_.end(), holds)); };
    return {seconds, walkers_.size(), count([](const Walker& w) { return w.is_streaming(); }), count([](const Walker& w) { return w.is_late(); })};
  }

  LoadOutcome finish() {
    outcome_.seconds = now();
    outcome_.arrived = walkers_.size();
    outcome_.is_interrupted = is_interrupted();
    for (Walker& walker : walkers_) outcome_.figures.add(walker.finish(outcome_.seconds));
    outcome_.own_cpu_s = cpu_seconds();
    // Each says goodbye and may wait for it; all at once, that is a second and not minutes.
    constexpr std::size_t kLeavers = 32;
    std::vector<std::jthread> leavers;
    std::atomic<std::size_t> next{0};
    std::vector<std::unique_ptr<Walker>> leaving;
    while (!walkers_.empty()) leaving.push_back(std::make_unique<Walker>(std::move(walkers_.front()))), walkers_.pop_front();
    for (std::size_t k = 0; k < std::min(kLeavers, leaving.size()); ++k)
      leavers.emplace_back([&] {
        for (std::size_t at = next++; at < leaving.size(); at = next++) leaving[at].reset();
      });
    leavers.clear();
    return std::move(outcome_);
  }

  const LoadOptions& options_;
  const WalkPlan& plan_;
  const ClientOptions client_;
  const Clock::time_point start_ = Clock::now();
  std::deque<Walker> walkers_;
  LoadOutcome outcome_;
};

}  // namespace

Result<LoadOutcome> run_load(const LoadOptions& options, const std::function<void(const LoadProgress&)>& progress) {
  const Result<WalkPlan> plan = WalkPlan::load(options.walk);
  if (!plan) return tl::unexpected(plan.error());
  ClientOptions client = options.client;
  std::unique_ptr<LinkProxy> link;
  if (!options.link.is_none()) {
    auto started = LinkProxy::start(client.server, options.link);
    if (!started) return tl::unexpected(started.error());
    link = std::move(*started);
    client.server = link->endpoint();
  }
  return LoadRun(options, *plan, std::move(client)).run(progress);
}

}  // namespace farfield::client
