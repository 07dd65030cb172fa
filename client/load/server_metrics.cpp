// SPDX-License-Identifier: Apache-2.0
#include "client/load/server_metrics.h"

#include <asio/ip/tcp.hpp>
#include <charconv>
#include <chrono>

namespace farfield::client {

Result<double> metric_of(std::string_view page, std::string_view name) {
  double sum = 0;
  bool is_there = false;
  while (!page.empty()) {
    const std::size_t end = std::min(page.find('\n'), page.size());
    const std::string_view line = page.substr(0, end);
    page.remove_prefix(std::min(end + 1, page.size()));
    if (!line.starts_with(name) || line.size() == name.size() || (line[name.size()] != ' ' && line[name.size()] != '{')) continue;
    double value = 0;
    const std::size_t space = line.rfind(' ');
    if (std::from_chars(line.data() + space + 1, line.data() + line.size(), value).ec != std::errc{}) continue;
    sum += value, is_there = true;
  }
  if (!is_there) return fail(ErrorCode::kNotFound, "the server's metrics have no {}", name);
  return sum;
}

Result<double> read_metric(const Endpoint& admin, std::string_view name) {
  constexpr std::chrono::seconds kPatience{5};
  constexpr std::size_t kMostBytes = std::size_t{1} << 22;
  asio::ip::tcp::iostream stream;
  stream.expires_after(kPatience);
  stream.connect(admin.host, std::to_string(admin.port));
  stream << "GET /metrics HTTP/1.0\r\nHost: " << admin.host << "\r\nConnection: close\r\n\r\n" << std::flush;
  std::string page;
  for (char buffer[4096]; stream.read(buffer, sizeof buffer) || stream.gcount() > 0;) {
    page.append(buffer, static_cast<std::size_t>(stream.gcount()));
    if (page.size() > kMostBytes) break;
  }
  if (page.empty()) return fail(ErrorCode::kUnavailable, "--admin {}: nobody answers there: {}", to_string(admin), stream.error().message());
  return metric_of(page, name);
}

}  // namespace farfield::client
