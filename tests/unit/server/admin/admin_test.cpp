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
  std::string reason;
  auto admin = AdminServer::start({"127.0.0.1", 0}, {[] { return std::string("farfield_x 1\n"); }, [&] { return reason; }});
  ASSERT_TRUE(admin) << admin.error().message;
  const auto get = [&](const std::string& target) {
    return fetch((*admin)->endpoint(), "GET " + target + " HTTP/1.1\r\nHost: x\r\n\r\n");
  };
  EXPECT_NE(get("/metrics").find("\r\n\r\nfarfield_x 1\n"), std::string::npos);
  EXPECT_EQ(get("/metrics").rfind("HTTP/1.1 200 OK\r\n", 0), 0u);
  EXPECT_EQ(get("/healthz?verbose=1").rfind("HTTP/1.1 200", 0), 0u);
  EXPECT_EQ(get("/readyz").rfind("HTTP/1.1 200", 0), 0u);
  reason = "draining";
  EXPECT_EQ(get("/readyz").rfind("HTTP/1.1 404", 0), 0u);
  EXPECT_EQ(get("/etc/passwd").rfind("HTTP/1.1 404", 0), 0u);
}

TEST(Admin, SurvivesWhatIsNoRequest) {
  auto admin = AdminServer::start({"127.0.0.1", 0}, {[] { return std::string(); }, [] { return std::string(); }});
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

// A service that has skipped a different number of each thing.
class SkippingService final : public MeasuredCellService {
 public:
  const SceneDescription& scene() const override { return scene_; }
  PlacedSceneChunk chunk_placement(std::uint32_t) const override { return {}; }
  SceneTexture texture(std::uint32_t) const override { return {}; }
  Ticket leaf(const glm::dvec3&, const WorkPriority&, Answer<SharedPlan>) override { return {}; }
  Ticket fallback(const glm::dvec3&, const WorkPriority&, Answer<SharedPlan>) override { return {}; }
  Ticket tile(const TileId&, const WorkPriority&, Answer<SharedTile>) override { return {}; }
  Ticket chunk(std::uint32_t, const WorkPriority&, Answer<SharedBytes>) override { return {}; }
  Ticket texture_level(std::uint32_t, int, const WorkPriority&, Answer<SharedBytes>) override { return {}; }
  std::vector<CellStatistics> cell_statistics() const override { return {}; }
  CellServiceStatistics statistics() const override {
    CellServiceStatistics s;
    s.skipped = {.empty_tiles = 11, .samples_coloured_once = 12, .hidden_samples = 13, .delta_blocks_hidden = 14, .delta_blocks_not_cast = 15, .delta_samples_held = 16, .samples_without_depth = 17, .identical_tiles = 18, .identical_bytes = 19};
    s.left_out.tiles_unseen = 21, s.left_out.tiles_too_small = 22, s.left_out.chunks_facing_away = 23, s.left_out.chunks_unseen = 24;
    s.left_out.triangles_unseen = 25, s.left_out.blocked_cells = 26, s.left_out.delta_views_unneeded = 27;
    s.blobs = {{.tier = "disk", .hits = 41, .capacity_bytes = 42}, {.tier = "redis", .is_reachable = false, .hits = 43, .rewritten = 44}};
    s.plans_made = 45, s.turns = {.leases = 46, .alone = 47, .waits = 48, .waits_in_vain = 49};
    return s;
  }

 private:
  SceneDescription scene_{.name = "s"};
};

TEST(ServerMetrics, CountsWhatWasSkipped) {
  PrometheusText out;
  const std::vector<std::shared_ptr<MeasuredCellService>> services{std::make_shared<SkippingService>()};
  write_metrics(out, services);
  SessionMetrics metrics;
  metrics.tiles_held = 31, metrics.payload_bytes_held = 32, metrics.leaves_blocked_ahead = 33;
  write_metrics(out, metrics);
  for (const char* line :
       {"farfield_tiles_empty_total{scene=\"s\"} 11\n", "farfield_samples_coloured_once_total{scene=\"s\"} 12\n",
        "farfield_samples_hidden_total{scene=\"s\"} 13\n", "farfield_delta_blocks_hidden_total{scene=\"s\"} 14\n",
        "farfield_delta_blocks_not_cast_total{scene=\"s\"} 15\n", "farfield_delta_samples_held_total{scene=\"s\"} 16\n",
        "farfield_samples_without_depth_total{scene=\"s\"} 17\n", "farfield_tiles_identical_total{scene=\"s\"} 18\n",
        "farfield_tile_bytes_identical_total{scene=\"s\"} 19\n",
        "farfield_tiles_unseen_total{scene=\"s\"} 21\n", "farfield_tiles_too_small_total{scene=\"s\"} 22\n",
        "farfield_chunks_facing_away_total{scene=\"s\"} 23\n", "farfield_chunks_unseen_total{scene=\"s\"} 24\n",
        "farfield_triangles_unseen_total{scene=\"s\"} 25\n", "farfield_cells_blocked_total{scene=\"s\"} 26\n",
        "farfield_delta_views_unneeded_total{scene=\"s\"} 27\n", "farfield_tiles_held_total 31\n", "farfield_payload_bytes_held_total 32\n",
        "farfield_leaves_blocked_ahead_total 33\n"})
    EXPECT_NE(out.text().find(line), std::string::npos) << line;
}

TEST(ServerMetrics, TellsTiersAndTurns) {
  PrometheusText out;
  write_metrics(out, std::vector<std::shared_ptr<MeasuredCellService>>{std::make_shared<SkippingService>()});
  for (const char* line :
       {"farfield_store_hits_total{tier=\"disk\"} 41\n", "farfield_store_capacity_bytes{tier=\"disk\"} 42\n", "farfield_store_hits_total{tier=\"redis\"} 43\n",
        "farfield_store_rewritten_total{tier=\"redis\"} 44\n", "farfield_store_reachable{tier=\"disk\"} 1\n", "farfield_store_reachable{tier=\"redis\"} 0\n",
        "farfield_leaf_plans_made_total{scene=\"s\"} 45\n", "farfield_leases_total{scene=\"s\"} 46\n", "farfield_leases_missing_total{scene=\"s\"} 47\n",
        "farfield_lease_waits_total{scene=\"s\"} 48\n", "farfield_lease_waits_in_vain_total{scene=\"s\"} 49\n"})
    EXPECT_NE(out.text().find(line), std::string::npos) << line;
  EXPECT_EQ(out.text().find("farfield_store_capacity_bytes{tier=\"redis\"}"), std::string::npos) << "bounded by Redis";
}

TEST(ServerMetrics, EveryNameIsDescribedOnce) {
  PrometheusText out;
  SessionMetrics metrics;
  ++metrics.sessions;
  write_metrics(out, metrics);
  write_metrics(out, std::vector<std::shared_ptr<MeasuredCellService>>{std::make_shared<SkippingService>()});
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
