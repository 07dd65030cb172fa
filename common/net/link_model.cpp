// SPDX-License-Identifier: Apache-2.0
#include "common/net/link_model.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace farfield {
namespace {

constexpr double kLongestSeconds = 60;  // of delay or jitter
constexpr double kLongestCutSeconds = 86400;
constexpr double kPacketBytes = 1448;  // TCP payload of an Ethernet packet with timestamps

struct Quantity {
  double value = 0;
  std::string_view unit;
};

Result<Quantity> parse_quantity(std::string_view text) {
  const std::string copy(text);
  char* end = nullptr;
  const double value = std::strtod(copy.c_str(), &end);
  const auto used = static_cast<std::size_t>(end - copy.c_str());
  if (used == 0 || !std::isfinite(value) || value < 0) {
    return fail(ErrorCode::kInvalidArgument, "'{}' is no number of zero or more", text);
  }
  return Quantity{value, text.substr(used)};
}

Result<double> parse_rate(std::string_view text) {
  const Result<Quantity> quantity = parse_quantity(text);
  if (!quantity) return tl::unexpected(quantity.error());
  for (const auto& [unit, factor] : {std::pair<std::string_view, double>{"bit", 1}, {"kbit", 1e3}, {"mbit", 1e6}, {"gbit", 1e9}}) {
    if (quantity->unit == unit) return quantity->value * factor;
  }
  return fail(ErrorCode::kInvalidArgument, "rate={}: write a unit: bit, kbit, mbit or gbit", text);
}

Result<double> parse_seconds(std::string_view key, std::string_view text, double longest) {
  const Result<Quantity> quantity = parse_quantity(text);
  if (!quantity) return tl::unexpected(quantity.error());
  for (const auto& [unit, factor] : {std::pair<std::string_view, double>{"us", 1e-6}, {"ms", 1e-3}, {"s", 1}}) {
    if (quantity->unit != unit) continue;
    if (quantity->value * factor <= longest) return quantity->value * factor;
    return fail(ErrorCode::kInvalidArgument, "{}={}: at most {} s are modelled", key, text, longest);
  }
  return fail(ErrorCode::kInvalidArgument, "{}={}: write a unit: us, ms or s", key, text);
}

Result<double> parse_share(std::string_view text) {
  const Result<Quantity> quantity = parse_quantity(text);
  if (!quantity) return tl::unexpected(quantity.error());
  if (quantity->unit != "%" || quantity->value > 100) {
    return fail(ErrorCode::kInvalidArgument, "loss={}: write a percentage from 0% to 100%", text);
  }
  return quantity->value / 100;
}

Status set_field(LinkModel& model, std::string_view key, std::string_view value) {
  Result<double> number = fail(ErrorCode::kInvalidArgument,
                               "'{}' is no property of a link: there are rate, delay, jitter, loss and cut", key);
  if (key == "rate") number = parse_rate(value);
  if (key == "delay" || key == "jitter") number = parse_seconds(key, value, kLongestSeconds);
  if (key == "cut") number = parse_seconds(key, value, kLongestCutSeconds);
  if (key == "loss") number = parse_share(value);
  if (!number) return tl::unexpected(number.error());
  if (key == "rate") model.rate_bits_per_second = *number;
  if (key == "delay") model.delay = LinkShaper::Seconds(*number);
  if (key == "jitter") model.jitter = LinkShaper::Seconds(*number);
  if (key == "loss") model.loss = *number;
  if (key == "cut") model.cut = LinkShaper::Seconds(*number);
  return {};
}

}  // namespace

std::size_t LinkModel::bandwidth_delay_bytes() const {
  return static_cast<std::size_t>(rate_bits_per_second / 8 * 2 * (delay + jitter).count());
}

Result<LinkModel> parse_link_model(std::string_view text) {
  LinkModel model;
  if (text == "none") return model;
  for (std::string_view rest = text; ;) {
    const std::string_view part = rest.substr(0, rest.find(','));
    const std::size_t equals = part.find('=');
    if (equals == std::string_view::npos) {
      return fail(ErrorCode::kInvalidArgument,
                  "link '{}': write none, or for example rate=20mbit,delay=50ms,jitter=20ms,loss=0.1%", text);
    }
    const Status set = set_field(model, part.substr(0, equals), part.substr(equals + 1));
    if (!set) return fail_within(fmt::format("link '{}'", text), set.error());
    if (part.size() == rest.size()) return model;
    rest.remove_prefix(part.size() + 1);
  }
}

std::string to_string(const LinkModel& model) {
  if (model.is_none()) return "none";
  std::string text;
  const auto add = [&](const std::string& part) { text += (text.empty() ? "" : ",") + part; };
  if (model.rate_bits_per_second > 0) add(fmt::format("rate={:g}mbit", model.rate_bits_per_second / 1e6));
  if (model.delay.count() > 0) add(fmt::format("delay={:g}ms", model.delay.count() * 1e3));
  if (model.jitter.count() > 0) add(fmt::format("jitter={:g}ms", model.jitter.count() * 1e3));
  if (model.loss > 0) add(fmt::format("loss={:g}%", model.loss * 100));
  if (model.cut.count() > 0) add(fmt::format("cut={:g}s", model.cut.count()));
  return text;
}

LinkShaper::Seconds LinkShaper::deliver(Seconds now, std::size_t bytes) {
  link_free_ = std::max(link_free_, now);
  if (model_.rate_bits_per_second > 0) {
    link_free_ += Seconds(8.0 * static_cast<double>(bytes) / model_.rate_bits_per_second);
  }
  Seconds delay = model_.delay;
  if (model_.jitter.count() > 0) delay += model_.jitter * std::uniform_real_distribution<double>()(random_);
  if (model_.loss > 0) {
    // Each packet is lost independently; each loss costs the round trip after which it is sent again.
    const auto packets = static_cast<int>(std::ceil(static_cast<double>(bytes) / kPacketBytes));
    const int lost = std::binomial_distribution<int>(packets, model_.loss)(random_);
    delay += lost * 2 * model_.delay;
  }
  last_delivery_ = std::max(last_delivery_, link_free_ + delay);
  return last_delivery_;
}

}  // namespace farfield
