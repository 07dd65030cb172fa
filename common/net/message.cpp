// SPDX-License-Identifier: Apache-2.0
#include "common/net/message.h"

#include <google/protobuf/stubs/logging.h>

#include <mutex>

namespace farfield {

void keep_protobuf_quiet() {
  static std::once_flag once;
  std::call_once(once, [] { google::protobuf::SetLogHandler(nullptr); });
}

}  // namespace farfield
