// SPDX-License-Identifier: Apache-2.0
#include "common/base/result.h"

namespace farfield {

const char* error_code_name(ErrorCode code) {
  switch (code) {
    case ErrorCode::kInvalidArgument: return "invalid argument";
    case ErrorCode::kNotFound: return "not found";
    case ErrorCode::kBadData: return "bad data";
    case ErrorCode::kLimitExceeded: return "limit exceeded";
    case ErrorCode::kUnavailable: return "unavailable";
    case ErrorCode::kIo: return "input/output";
    case ErrorCode::kCancelled: return "cancelled";
    case ErrorCode::kVersionMismatch: return "version mismatch";
    case ErrorCode::kUnauthenticated: return "unauthenticated";
    case ErrorCode::kInternal: return "internal";
  }
  return "unknown";
}

tl::unexpected<Error> fail_within(const std::string& context, Error error) {
  error.message = context + ": " + error.message;
  return tl::unexpected<Error>(std::move(error));
}

}  // namespace farfield
