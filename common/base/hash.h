// SPDX-License-Identifier: Apache-2.0
// Content hashes: 64-bit XXH3. They name what is cached and sent; they are no defence against forgery.
#pragma once

#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>

#include "common/base/bytes.h"

namespace farfield {

using ContentHash = std::uint64_t;

ContentHash hash_bytes(ByteView bytes, std::uint64_t seed = 0);

template <class T>
ContentHash hash_values(std::span<const T> values, std::uint64_t seed = 0) {
  static_assert(std::is_trivially_copyable_v<T>);
  return hash_bytes({reinterpret_cast<const std::uint8_t*>(values.data()), values.size_bytes()}, seed);
}

template <class T>
ContentHash hash_value(const T& value, std::uint64_t seed = 0) {
  return hash_values(std::span<const T>(&value, 1), seed);
}

}  // namespace farfield
