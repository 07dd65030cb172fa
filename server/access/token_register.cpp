// SPDX-License-Identifier: Apache-2.0
#include "server/access/token_register.h"

#include <fstream>

namespace farfield {
namespace {

constexpr std::uintmax_t kLargestFile = std::uintmax_t{32} << 20;

WallTime system_now() { return std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now()); }

}  // namespace

Error access_refused() { return {ErrorCode::kUnauthenticated, "access refused: a valid access token is needed (--token-file)"}; }

TokenRegister::TokenRegister(std::filesystem::path file, Now now) : file_(std::move(file)), now_(now ? std::move(now) : system_now) {}

Result<std::shared_ptr<TokenRegister>> TokenRegister::load(std::filesystem::path file, Now now) {
  std::shared_ptr<TokenRegister> tokens(new TokenRegister(std::move(file), std::move(now)));
  if (Status status = tokens->reload(); !status) return tl::unexpected(status.error());
  return tokens;
}

Status TokenRegister::reload() {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(file_, error);
  if (error) return fail(ErrorCode::kNotFound, "{}: no list of tokens can be read there ({})", file_.string(), error.message());
  if (size > kLargestFile) return fail(ErrorCode::kLimitExceeded, "{}: {} bytes are more than a list of tokens may have", file_.string(), size);
  std::string text(size, '\0');
  std::ifstream in(file_, std::ios::binary);
  in.read(text.data(), static_cast<std::streamsize>(size));
  if (!in) return fail(ErrorCode::kIo, "{}: cannot be read", file_.string());
  Result<std::vector<TokenEntry>> entries = parse_tokens(text, file_.string());
  if (!entries) return tl::unexpected(entries.error());
  auto shared = std::make_shared<const std::vector<TokenEntry>>(std::move(*entries));
  const std::lock_guard lock(mutex_);
  entries_ = std::move(shared);
  ++generation_;
  return {};
}

std::optional<Admission> TokenRegister::find(const TokenDigest& digest) const {
  std::shared_ptr<const std::vector<TokenEntry>> entries;
  std::uint64_t generation = 0;
  {
    const std::lock_guard lock(mutex_);
    entries = entries_;
    generation = generation_;
  }
  // To the end, wherever it is found.
  const TokenEntry* found = nullptr;
  for (const TokenEntry& entry : *entries) found = is_same(entry.digest, digest) ? &entry : found;
  if (!found || now_() >= found->expires) return std::nullopt;
  return Admission{*found, generation};
}

std::optional<Admission> TokenRegister::admit(std::string_view token) const {
  return find(digest_of(token.substr(0, kLongestAccessToken + 1)));
}

bool TokenRegister::is_valid(Admission& admission) const {
  std::uint64_t generation = 0;
  {
    const std::lock_guard lock(mutex_);
    generation = generation_;
  }
  if (admission.generation == generation) return now_() < admission.entry.expires;
  std::optional<Admission> found = find(admission.entry.digest);
  if (found) admission = std::move(*found);
  return found.has_value();
}

std::size_t TokenRegister::size() const {
  const std::lock_guard lock(mutex_);
  return entries_->size();
}

}  // namespace farfield
