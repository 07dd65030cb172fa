// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/promises.h"

#include "tests/bench/distribution.h"

namespace farfield::bench {

namespace {

double number_from(const nlohmann::json& json) { return json.is_null() ? kNone : json.get<double>(); }
nlohmann::json value(double number) { return std::isfinite(number) ? nlohmann::json(number) : nlohmann::json(nullptr); }

}  // namespace

FramePromise promise_from(const nlohmann::json& json) {
  const auto number = [&](std::size_t at) { return number_from(json.at(at)); };
  return {number(0), number(1), number(2), number(3), number(4)};
}

nlohmann::json to_json(const FramePromise& promise) {
  return {value(promise.void_share), value(promise.psnr_db), value(promise.warp_px), value(promise.expected_void_share), value(promise.expected_psnr_db)};
}

nlohmann::json to_json(const KeptPromise& frame) {
  const FramePromise& p = frame.promise;
  return {{"void_share", {value(p.void_share), value(frame.void_share)}},
          {"psnr_db", {value(p.psnr_db), value(frame.psnr_db)}},
          {"warp_px", {value(p.warp_px), value(frame.warp_px)}},
          {"expected", {{"void_share", value(p.expected_void_share)}, {"psnr_db", value(p.expected_psnr_db)}}}};
}

KeptPromise kept_promise_from(const nlohmann::json& json) {
  KeptPromise frame;
  const auto pair = [&](const char* key, double& promised, double& measured) {
    promised = number_from(json.at(key).at(0)), measured = number_from(json.at(key).at(1));
  };
  pair("void_share", frame.promise.void_share, frame.void_share);
  pair("psnr_db", frame.promise.psnr_db, frame.psnr_db);
  pair("warp_px", frame.promise.warp_px, frame.warp_px);
  frame.promise.expected_void_share = number_from(json.at("expected").at("void_share"));
  frame.promise.expected_psnr_db = number_from(json.at("expected").at("psnr_db"));
  return frame;
}

// Comparisons with NaN are false: what was not promised or not measured is not broken.
bool KeptPromise::holds() const {
  const bool is_broken = void_share > promise.void_share || psnr_db < promise.psnr_db || warp_px > promise.warp_px;
  return !is_broken;
}

CertificateFigures certificate_figures(const std::vector<KeptPromise>& frames) {
  std::vector<double> void_share, psnr, warp, void_slack, psnr_slack, warp_slack, holds;
  const auto add = [](std::vector<double>& values, double value) {
    if (std::isfinite(value)) values.push_back(value);
  };
  for (const KeptPromise& frame : frames) {
    const FramePromise& promise = frame.promise;
    add(void_share, promise.void_share), add(psnr, promise.psnr_db), add(warp, promise.warp_px);
    add(void_slack, promise.void_share - frame.void_share), add(psnr_slack, frame.psnr_db - promise.psnr_db);
    add(warp_slack, promise.warp_px - frame.warp_px);
    if (std::isfinite(promise.void_share) || std::isfinite(promise.psnr_db)) holds.push_back(frame.holds() ? 1 : 0);
  }
  return {.void_share = mean(void_share), .psnr_db = mean(psnr), .warp_px = mean(warp), .holds_share = mean(holds),
          .void_slack = mean(void_slack), .psnr_slack_db = mean(psnr_slack), .warp_slack_px = mean(warp_slack)};
}

}  // namespace farfield::bench
