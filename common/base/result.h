// SPDX-License-Identifier: Apache-2.0
// The way foreseeable failures (files, network bytes, quotas) travel: a value or an Error, never an exception.
#pragma once

#include <fmt/format.h>

#include <string>
#include <tl/expected.hpp>
#include <utility>

namespace farfield {

enum class ErrorCode {
  kInvalidArgument,   // a flag or a request that cannot be meant
  kNotFound,          // a file, scene or host that is not there
  kBadData,           // bytes that are not what they claim to be
  kLimitExceeded,     // more than an announced limit allows
  kUnavailable,       // the other side is gone or busy: try again later
  kIo,                // disk or socket
  kCancelled,         // nobody wants the result any more
  kVersionMismatch,   // the other side speaks another version
  kUnauthenticated,   // no or wrong token
  kInternal,          // a library failed in a way its documentation does not foresee
};

const char* error_code_name(ErrorCode code);

/// What went wrong, where, and what to do about it, in one line of `message`.
struct Error {
  ErrorCode code = ErrorCode::kInternal;
  std::string message;
};

template <class T>
using Result = tl::expected<T, Error>;
using Status = tl::expected<void, Error>;

/// fail(ErrorCode::kNotFound, "{}: no such file", path)
template <class... Args>
[[nodiscard]] tl::unexpected<Error> fail(ErrorCode code, fmt::format_string<Args...> format, Args&&... args) {
  return tl::unexpected<Error>(Error{code, fmt::format(format, std::forward<Args>(args)...)});
}

/// Passes an error on, with `context` put before its message: "context: message".
[[nodiscard]] tl::unexpected<Error> fail_within(const std::string& context, Error error);

}  // namespace farfield
