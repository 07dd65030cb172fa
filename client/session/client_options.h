// SPDX-License-Identifier: Apache-2.0
// What a client core is told when it is made.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include "client/decode/payload_decoder.h"
#include "common/math/camera.h"
#include "common/net/endpoint.h"
#include "common/net/tls.h"

namespace farfield::client {

struct ClientOptions {
  Endpoint server;
  std::shared_ptr<const TlsClient> tls;  // null: a plain connection
  std::string access_token;             // empty: none; the server says whether it asks for one
  std::string scene;                    // name in the server's catalogue; empty: its first
  std::string program = "farfield-client";
  Display display;                      // told to the server
  DecodeForm form = DecodeForm::kBoth;  // each form costs memory and decoding time of its own
  int decode_threads = 2;
  /// Hard cap on decoded payloads. The default leaves room for frame buffers, encoded payloads on their way and the
  /// heap's own slack below 600 MB of process.
  std::size_t store_bytes = std::size_t{448} << 20;
  // Encoded payloads that wait for decoding; beyond it the socket is not read: TCP's back-pressure reaches the server.
  std::size_t decode_queue_bytes = std::size_t{4} << 20;
  bool use_fallback = true;             // ask for the fallback view when nothing usable is on the screen
  std::chrono::milliseconds connect_timeout{5000};
  std::chrono::milliseconds heartbeat{10000};         // a server silent for three of these is gone
  std::chrono::milliseconds refresh_interval{50};     // between new snapshots while the shown set is being refined
  TileDecoder tile_decoder;             // empty: the codec of common/codec
};

}  // namespace farfield::client
