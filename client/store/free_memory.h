// SPDX-License-Identifier: Apache-2.0
// Gives memory that was freed back to the operating system. Thread-safe.
//
// The C library keeps freed blocks of the sizes tiles have, in one heap per decoding thread, in case they are needed
// again. After a switch of leaf sets that can be as much again as the store holds.
#pragma once

namespace farfield::client {

/// Some milliseconds for some hundred megabytes; allocations of other threads may wait for part of it. Does nothing
/// where the C library offers no way.
void return_free_memory();

}  // namespace farfield::client
