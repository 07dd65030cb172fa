// SPDX-License-Identifier: Apache-2.0
// Traces as text: one line `t x y z qx qy qz qw` per frame (the order of the TUM RGB-D benchmark, Sturm 2012), with
// header comments for scene, frame and units. Numbers carry as many digits as a double needs: reading gives back
// exactly what was written.
//
//   # farfield trace 1
//   # scene: pipes:1000000:1
//   # frame: world (right-handed, +Y up, the camera looks along its -Z)
//   # units: metres, seconds
//   0 12.5 1.7 -3 0 0 0 1
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "common/trace/trace.h"

namespace farfield {

inline constexpr std::size_t kMaxTraceFrames = 10'000'000;
inline constexpr std::size_t kMaxTraceBytes = std::size_t{2} << 30;

std::string format_trace(const Trace& trace);
/// `name` stands before messages. Comments that are not header lines, and empty lines, are skipped; files without a
/// header are taken to be in the world frame and metres. Quaternions are normalised.
/// Errors: kBadData "name:line: what is wrong", kLimitExceeded.
Result<Trace> parse_trace(std::string_view text, const std::string& name);

/// Errors: kNotFound, kIo, and those of parse_trace.
Result<Trace> read_trace(const std::filesystem::path& path);
/// Writes beside the file and renames, so that a reader never sees half a trace. Errors: kIo.
Status write_trace(const std::filesystem::path& path, const Trace& trace);

}  // namespace farfield
