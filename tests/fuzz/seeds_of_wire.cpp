// SPDX-License-Identifier: Apache-2.0
#include "common/impostor/direction_mask.h"
#include "common/net/message.h"
#include "common/trace/trace_file.h"
#include "proto/farfield.pb.h"
#include "tests/fuzz/seeds.h"

namespace farfield::fuzz {
namespace {

Bytes encoded(const google::protobuf::MessageLite& message) {
  Bytes bytes(message.ByteSizeLong());
  message.SerializeToArray(bytes.data(), static_cast<int>(bytes.size()));
  return bytes;
}

void append(Bytes& stream, const OutgoingFrame& frame) {
  stream.insert(stream.end(), frame.head.begin(), frame.head.end());
  if (frame.payload) stream.insert(stream.end(), frame.payload->begin(), frame.payload->end());
}

wire::Hello hello() {
  wire::Hello message;
  message.set_version_min(1);
  message.set_version_max(1);
  message.set_program("seed");
  message.set_scene("plant");
  message.mutable_display()->set_width(1280);
  message.mutable_display()->set_height(720);
  message.mutable_display()->set_fovy_rad(1.0);
  message.set_resume_token("0123456789abcdef");
  message.add_held(0x1122334455667788);
  message.set_store_bytes(1 << 20);
  message.set_access_token("farfield_" + std::string(64, '7'));
  return message;
}

wire::Pose pose() {
  wire::Pose message;
  message.mutable_cell()->set_level(3);
  message.mutable_cell()->set_x(40000000);
  message.mutable_cell()->set_y(40000001);
  message.mutable_cell()->set_z(40000002);
  message.set_dx(0.25f);
  message.set_qw(1);
  message.set_time_s(2.5);
  message.set_sequence(7);
  return message;
}

wire::Welcome welcome() {
  wire::Welcome message;
  message.set_version(1);
  message.set_resume_token("0123456789abcdef");
  message.mutable_limits()->set_frame_bytes(1 << 20);
  message.mutable_limits()->set_held(1000);
  wire::CatalogueEntry& entry = *message.add_catalogue();
  entry.set_name("plant");
  entry.set_triangles(1000000);
  wire::SceneInfo& scene = *message.mutable_scene();
  scene.set_name("plant");
  scene.set_scene_hash(42);
  scene.mutable_origin()->set_x(84616.5);
  scene.mutable_bounds_max()->set_x(10);
  scene.set_finest_side_m(0.5);
  scene.set_kappa(2);
  scene.set_tau_px(0.25);
  scene.set_edge_samples(1514);
  scene.mutable_start()->set_y(1.7);
  return message;
}

wire::LeafSet leaf_set(bool is_placed_by_translation) {
  wire::LeafSet message;
  message.set_serial(5);
  message.mutable_leaf()->set_level(2);
  message.mutable_leaf()->set_x(1000);
  message.mutable_root()->set_level(8);
  message.set_is_current(true);
  for (std::uint64_t tile = 1; tile < 5; ++tile) message.add_tiles(tile * 0x9e3779b97f4a7c15);
  wire::Placement& placement = *message.add_chunks();
  placement.set_chunk(77);
  placement.set_texture(78);
  for (int i = 0; i < (is_placed_by_translation ? 3 : 12); ++i) placement.add_transform(0.5f * static_cast<float>(i));
  message.set_sky(std::string(DirectionMask::kBytes, '\x0f'));
  if (is_placed_by_translation) message.set_enclosure("\x11\x11\x01");
  return message;
}

void add_frames(Seeds& seeds) {
  Bytes stream;
  append(stream, make_message(MessageType::kHello, hello()));
  append(stream, make_message(MessageType::kPose, pose()));
  seeds.push_back({"frame", "hello_and_pose", chosen(15, stream)});
  wire::TilePayload tile;
  tile.set_key(9);
  Bytes payload_stream;
  append(payload_stream, make_message(MessageType::kTilePayload, tile, std::make_shared<const Bytes>(300, 0x5a)));
  append(payload_stream, make_message(MessageType::kTilePayload, tile));
  seeds.push_back({"frame", "payloads", chosen(200, payload_stream)});
}

}  // namespace

void add_wire_seeds(Seeds& seeds) {
  add_frames(seeds);
  seeds.push_back({"client_messages", "pose", chosen(0, encoded(pose()))});
  seeds.push_back({"client_messages", "hello", chosen(1, encoded(hello()))});
  const std::string digest = "sha256:" + std::string(64, 'a');
  seeds.push_back({"token_file", "two", bytes_of("# who may come in\n" + digest + " alice viewer 2027-01-31T12:00:00Z\nsha256:" + std::string(64, 'B') + "\tbob@example.org admin 2030-02-28 # ops\n")});
  seeds.push_back({"token_file", "broken", bytes_of(digest + " alice king 2027-02-30\n")});
  seeds.push_back({"token_file", "days", bytes_of("30d")});
  wire::Evicted evicted;
  for (std::uint64_t key = 1; key < 4; ++key) evicted.add_payloads(key << 40);
  seeds.push_back({"client_messages", "evicted", chosen(2, encoded(evicted))});

  seeds.push_back({"server_messages", "welcome", chosen(0, encoded(welcome()))});
  seeds.push_back({"server_messages", "leaf_set", chosen(1, encoded(leaf_set(false)))});
  seeds.push_back({"server_messages", "leaf_set_translated", chosen(1, encoded(leaf_set(true)))});
  wire::Failure failure;
  failure.set_code(3);
  failure.set_message("no such scene");
  failure.set_fatal(true);
  seeds.push_back({"server_messages", "failure", chosen(2, encoded(failure))});
  wire::TexturePayload texture;
  texture.set_texture(1);
  texture.set_level(2);
  texture.set_level_count(4);
  texture.set_key(3);
  seeds.push_back({"server_messages", "texture_payload", chosen(4, encoded(texture))});

  Trace trace;
  trace.scene = "pipes:1000000:1";
  for (int i = 0; i < 4; ++i) trace.frames.push_back({0.5 * i, Pose{{1.0 / 3 * i, 1.7, -3e5}}});
  seeds.push_back({"trace", "written", bytes_of(format_trace(trace))});
  seeds.push_back({"trace", "bare", bytes_of("# a remark\n\n0 0 0 0 0 0 0 2\n1e0 1 -2 3.5 0.5 0.5 0.5 0.5\r\n")});

  seeds.push_back({"command_words", "link", bytes_of("rate=20mbit,delay=50ms,jitter=20ms,loss=0.1%")});
  seeds.push_back({"command_words", "none", bytes_of("none")});
  seeds.push_back({"command_words", "endpoint", bytes_of("scenes.example.org:7400")});
  seeds.push_back({"command_words", "endpoint_v6", bytes_of("[::1]:7400")});
}

}  // namespace farfield::fuzz
