// SPDX-License-Identifier: Apache-2.0
// What all sessions of a server did, counted. Counters only rise; read from any thread.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>

#include "common/net/connection.h"

namespace farfield {

struct SessionMetrics {
  using Counter = std::atomic<std::uint64_t>;

  std::shared_ptr<ConnectionCounters> traffic = std::make_shared<ConnectionCounters>();
  std::atomic<std::int64_t> open_sessions{0};
  Counter sessions{0}, resumed_sessions{0}, refused_sessions{0};
  Counter failed_handshakes{0};        // of TLS: cut, too slow, no common version, no TLS at all
  Counter refused_tokens{0};           // Hello with no valid access token
  Counter poses{0}, poses_dropped{0}, leaves_deferred{0};
  Counter leaf_sets{0}, leaf_sets_prefetched{0}, leaf_sets_fallback{0}, leaf_sets_complete{0};
  Counter leaf_sets_reused{0};         // entered, and announced before: no manifest sent
  Counter payloads_tile{0}, payloads_chunk{0}, payloads_texture{0}, payloads_empty_tile{0};
  Counter payload_bytes{0};
  Counter payloads_held{0};            // needed and not sent, because the client holds them: of an earlier leaf
  Counter tiles_held{0};               // of these, tiles: of shells that neighbouring leaves share
  Counter payload_bytes_held{0};       // of these payloads, as far as this connection has sent them
  Counter leaves_blocked_ahead{0};     // on a predicted path, and not made: nobody can stand in them
  Counter payloads_stale{0};           // withdrawn before they were sent: the viewer went elsewhere
  Counter payloads_failed{0};          // the cell service could not make them
  Counter unknown_frames{0};           // of types this build does not know
  Counter bad_frames{0};               // garbage, oversized, other layout versions, messages out of place
};

}  // namespace farfield
