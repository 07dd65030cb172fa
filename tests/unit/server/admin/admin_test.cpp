// SPDX-License-Identifier: Apache-2.0
#include "server/admin/admin_server.h"

#include <gtest/gtest.h>

#include <asio/io_context.hpp>
#include <asio/ip/tcp.hpp>
#include <asio/read.hpp>
#include <asio/write.hpp>

#include "server/admin/server_metrics.h"

namespace farfield {
namespace {

std::string fetch(const Endpoint& endpoint, const std::string& request) {
  asio::io_context context;
  asio::ip::tcp::socket socket(context);
  socket.connect({asio::ip::make_address(endpoint.host), endpoint.port});
  asio::write(socket, asio::buffer(request));
  std::string reply;
  asio::error_code error;
  asio::read(socket, asio::dynamic_buffer(reply), error);
  return reply;
}

TEST(Admin, AnswersItsThreePages) {
  bool is_ready = true;
  auto admin = AdminServer::start({"127.0.0.1", 0}, {[] { return std::string("farfield_x 1\n"); }, [&] { return is_ready; }});
  ASSERT_TRUE(admin) << admin.error().message;
  const auto get = [&](const std::string& target) {
    return fetch((*admin)->endpoint(), "GET " + target + " HTTP/1.1\r\nHost: x\r\n\r\n");
  };
  EXPECT_NE(get("/metrics").find("\r\n\r\nfarfield_x 1\n"), std::string::npos);
  EXPECT_EQ(get("/metrics").rfind("HTTP/1.1 200 OK\r\n", 0), 0u);
  EXPECT_EQ(get("/healthz?verbose=1").rfind("HTTP/1.1 200", 0), 0u);
  EXPECT_EQ(get("/readyz").rfind("HTTP/1.1 200", 0), 0u);
  is_ready = false;
  EXPECT_EQ(get("/readyz").rfind("HTTP/1.1 503", 0), 0u);
  EXPECT_EQ(get("/etc/passwd").rfind("HTTP/1.1 404", 0), 0u);
}

TEST(Admin, SurvivesWhatIsNoRequest) {
  auto admin = AdminServer::start({"127.0.0.1", 0}, {[] { return std::string(); }, [] { return true; }});
  ASSERT_TRUE(admin);
  EXPECT_EQ(fetch((*admin)->endpoint(), "nonsense\r\n\r\n").rfind("HTTP/1.1 400", 0), 0u);
  EXPECT_EQ(fetch((*admin)->endpoint(), "POST /metrics HTTP/1.1\r\n\r\n").rfind("HTTP/1.1 405", 0), 0u);
  EXPECT_EQ(fetch((*admin)->endpoint(), std::string(20000, 'x')), "") << "too long: closed without an answer";
  EXPECT_EQ(fetch((*admin)->endpoint(), "GET /healthz HTTP/1.1\r\n\r\n").rfind("HTTP/1.1 200", 0), 0u);
}

TEST(Admin, APortInUseIsAnError) {
  auto first = AdminServer::start({"127.0.0.1", 0}, {});
  ASSERT_TRUE(first);
  const auto second = AdminServer::start((*first)->endpoint(), {});
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, ErrorCode::kUnavailable);
}

TEST(PrometheusText, WritesTheFormat) {
  PrometheusText out;
  out.counter("a_total", "What a is.", 3, {"kind", "x\"y\n"});
  out.counter("a_total", "What a is.", 4, {"kind", "z"});
  out.gauge("b", "B.", 0.5);
  EXPECT_EQ(out.text(),
            "# HELP a_total What a is.\n# TYPE a_total counter\na_total{kind=\"x\\\"y\\n\"} 3\na_total{kind=\"z\"} 4\n"
            "# HELP b B.\n# TYPE b gauge\nb 0.5\n");
}

TEST(PrometheusText, HistogramsAccumulate) {
  DurationHistogram histogram;
  for (const double seconds : {0.0001, 0.004, 0.004, 100.0}) histogram.add(seconds);
  PrometheusText out;
  out.histogram("h_seconds", "H.", histogram);
  EXPECT_NE(out.text().find("h_seconds_bucket{le=\"0.0005\"} 1\n"), std::string::npos) << out.text();
  EXPECT_NE(out.text().find("h_seconds_bucket{le=\"0.005\"} 3\n"), std::string::npos);
  EXPECT_NE(out.text().find("h_seconds_bucket{le=\"+Inf\"} 4\n"), std::string::npos);
  EXPECT_NE(out.text().find("h_seconds_count 4\n"), std::string::npos);
}

TEST(ServerMetrics, EveryNameIsDescribedOnce) {
  PrometheusText out;
  SessionMetrics metrics;
  ++metrics.sessions;
  write_metrics(out, metrics);
  write_process_metrics(out);
  EXPECT_NE(out.text().find("farfield_sessions_total 1\n"), std::string::npos);
  EXPECT_NE(out.text().find("process_resident_memory_bytes "), std::string::npos);
  std::size_t at = 0;
  while ((at = out.text().find("# TYPE ", at)) != std::string::npos) {
    const std::string line = out.text().substr(at, out.text().find('\n', at) - at);
    EXPECT_EQ(out.text().find(line, at + 1), std::string::npos) << line;
    ++at;
  }
}

}  // namespace
}  // namespace farfield
