// SPDX-License-Identifier: Apache-2.0
// The tokens that are good now: read from a file, read again when it has changed.
//
// Whoever fails learns nothing: a wrong token, an expired one, a revoked one and none at all get the same answer after the same work.
// Threads: any.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>

#include "server/access/token_file.h"

namespace farfield {

/// The one answer to whoever has no valid token.
Error access_refused();

/// Somebody whose token was good when it was last looked at.
struct Admission {
  TokenEntry entry;
  std::uint64_t generation = 0;  // of the list it was found in
};

class TokenRegister {
 public:
  using Now = std::function<WallTime()>;

  /// `now`: the wall clock; empty: the system's. Errors: kNotFound, kIo, kBadData, kLimitExceeded.
  static Result<std::shared_ptr<TokenRegister>> load(std::filesystem::path file, Now now = {});

  /// Errors: as load(); the list stays as it was then.
  Status reload();
  /// In a time that depends on how many tokens there are and not on which.
  std::optional<Admission> admit(std::string_view token) const;
  /// Whether the token is still listed and has not expired; role and expiry are brought up to date. Cheap.
  bool is_valid(Admission& admission) const;
  std::size_t size() const;

 private:
  TokenRegister(std::filesystem::path file, Now now);
  std::optional<Admission> find(const TokenDigest& digest) const;

  const std::filesystem::path file_;
  const Now now_;
  mutable std::mutex mutex_;  // guards what follows
  std::shared_ptr<const std::vector<TokenEntry>> entries_;
  std::uint64_t generation_ = 0;
};

}  // namespace farfield
