// SPDX-License-Identifier: Apache-2.0
// What was learned of viewers' ways, from a store that somebody else may have written to.
#include "server/schedule/transition_table.h"
#include "tests/fuzz/require.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  farfield::TransitionTable table;
  if (!table.read({data, size})) return 0;
  farfield::TransitionTable again;
  farfield::fuzz::require(again.read(table.write()).has_value(), "what was read can be written and read");
  for (std::uint8_t level = 0; level < 4; ++level) {
    double sum = 0;
    for (const farfield::LikelyNext& next : table.from(std::nullopt, {.level = level}).next) sum += next.probability;
    farfield::fuzz::require(sum < 1, "something that was not seen is always possible");
  }
  return 0;
}
