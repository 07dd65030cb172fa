// SPDX-License-Identifier: Apache-2.0
#include "server/app/token_tool.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "common/base/command_line.h"
#include "common/base/complete_file.h"
#include "server/access/token_file.h"

namespace farfield {
namespace {

constexpr const char* kFooter = R"(Examples:
  farfield-token add --tokens tokens --user alice --expires 30d --output alice.token
  farfield-token add --tokens tokens --user ops --role admin --expires 2027-01-31 > ops.token
  farfield-token list --tokens tokens --json
  farfield-token revoke --tokens tokens --user alice

The list holds digests, never a token: one that is lost is made anew. A running server reads it again on SIGHUP; those whose
token is revoked or over leave within a second.
Exit codes: 0 done, 1 failed, 2 wrong usage.)";

struct TokenOptions {
  std::filesystem::path tokens, output;
  std::string user, role = "viewer", expires;
  bool is_json = false;
};

WallTime wall_now() { return std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now()); }

/// Lines are changed where they stand, so that what people wrote between them stays.
Result<std::string> read_list(const std::filesystem::path& file, bool may_be_missing) {
  std::error_code ignored;
  if (may_be_missing && !std::filesystem::exists(file, ignored)) return std::string();
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  if (!in || !(text << in.rdbuf() || in.peek() == std::ifstream::traits_type::eof())) {
    return fail(ErrorCode::kNotFound, "--tokens: {} cannot be read", file.string());
  }
  return text.str();
}

Status write_private_file(const std::filesystem::path& file, const std::string& text) {
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (descriptor < 0) return fail(ErrorCode::kIo, "--output: {} cannot be made: {}", file.string(), std::strerror(errno));
  const bool is_written = ::write(descriptor, text.data(), text.size()) == static_cast<ssize_t>(text.size()) && ::fsync(descriptor) == 0;
  ::close(descriptor);
  if (!is_written) return fail(ErrorCode::kIo, "--output: {} cannot be written", file.string());
  return {};
}

Status add(const TokenOptions& options, std::ostream& out) {
  if (!is_user_name(options.user)) return fail(ErrorCode::kInvalidArgument, "--user: letters, digits and . _ @ + -, at most 64");
  const Result<WallTime> expires = parse_expiry(options.expires, wall_now());
  if (!expires) return fail_within("--expires", expires.error());
  if (*expires <= wall_now()) return fail(ErrorCode::kInvalidArgument, "--expires: {} is over already", format_expiry(*expires));
  Result<std::string> list = read_list(options.tokens, true);
  if (!list) return tl::unexpected(list.error());
  const auto entries = parse_tokens(*list, options.tokens.string());
  if (!entries) return tl::unexpected(entries.error());
  const Result<std::string> token = make_access_token();
  if (!token) return tl::unexpected(token.error());
  if (!list->empty() && list->back() != '\n') *list += '\n';
  const TokenEntry entry{digest_of(*token), options.user, *parse_role(options.role), *expires};
  // Handed over before it is listed: nobody can lose what nobody has.
  if (!options.output.empty()) {
    if (Status written = write_private_file(options.output, *token + "\n"); !written) return written;
  }
  if (Status written = write_complete_file(options.tokens, *list + format_token(entry)); !written) return written;
  if (options.is_json) {
    nlohmann::json said{{"user", entry.user}, {"role", options.role}, {"expires", format_expiry(entry.expires)}};
    if (options.output.empty()) said["token"] = *token;
    out << said.dump() << '\n';
  } else if (options.output.empty()) {
    out << *token << '\n';
  }
  if (!out.flush()) return fail(ErrorCode::kIo, "the token cannot be written to the output: revoke it");
  return {};
}

Status list(const TokenOptions& options, std::ostream& out) {
  const Result<std::string> text = read_list(options.tokens, false);
  if (!text) return tl::unexpected(text.error());
  const auto entries = parse_tokens(*text, options.tokens.string());
  if (!entries) return tl::unexpected(entries.error());
  nlohmann::json all = nlohmann::json::array();
  const WallTime now = wall_now();
  for (const TokenEntry& entry : *entries) {
    // Enough of the digest to tell two of one user apart.
    const std::string id = to_hex(entry.digest).substr(0, 12), expires = format_expiry(entry.expires);
    const bool is_over = now >= entry.expires;
    all.push_back({{"id", id}, {"user", entry.user}, {"role", role_name(entry.role)}, {"expires", expires}, {"is_over", is_over}});
    if (!options.is_json) out << fmt::format("{} {:<24} {:<8} {}{}\n", id, entry.user, role_name(entry.role), expires, is_over ? " over" : "");
  }
  if (options.is_json) out << all.dump() << '\n';
  return out.flush() ? Status() : fail(ErrorCode::kIo, "the list cannot be written to the output");
}

Status revoke(const TokenOptions& options, std::ostream& out) {
  const Result<std::string> text = read_list(options.tokens, false);
  if (!text) return tl::unexpected(text.error());
  if (const auto entries = parse_tokens(*text, options.tokens.string()); !entries) return tl::unexpected(entries.error());
  std::string kept, line;
  std::size_t revoked = 0;
  for (std::istringstream lines(*text); std::getline(lines, line);) {
    const auto entry = parse_tokens(line, "");
    const bool is_theirs = entry && !entry->empty() && entry->front().user == options.user;
    revoked += is_theirs ? 1 : 0;
    if (!is_theirs) kept += line + "\n";
  }
  if (revoked == 0) return fail(ErrorCode::kNotFound, "no token of '{}' in {}", options.user, options.tokens.string());
  if (Status written = write_complete_file(options.tokens, kept); !written) return written;
  out << (options.is_json ? nlohmann::json{{"user", options.user}, {"revoked", revoked}}.dump() : fmt::format("{} revoked", revoked)) << '\n';
  return out.flush() ? Status() : fail(ErrorCode::kIo, "the result cannot be written to the output");
}

}  // namespace

int run_token_tool(int argument_count, const char* const* arguments, std::ostream& out, std::ostream& talk) {
  CLI::App app{"Make access tokens for a Farfield server, and keep its list of them.", "farfield-token"};
  app.footer(kFooter);
  app.set_version_flag("--version", "farfield-token " FARFIELD_VERSION);
  app.require_subcommand(1);
  TokenOptions options;
  CLI::App* adding = app.add_subcommand("add", "Make a token: it is printed, its digest is added to the list");
  adding->add_option("--role", options.role, "viewer, reviewer or admin")->check(CLI::IsMember({"viewer", "reviewer", "admin"}))->capture_default_str();
  adding->add_option("--expires", options.expires, "30d, 12h, 2027-01-31 or 2027-01-31T12:00:00Z")->required();
  adding->add_option("-o,--output", options.output, "New file for the token, readable by its owner alone (default: standard output)");
  CLI::App* listing = app.add_subcommand("list", "Whose tokens are listed, and until when");
  CLI::App* revoking = app.add_subcommand("revoke", "Take all tokens of a user from the list");
  for (CLI::App* command : {adding, listing, revoking}) {
    command->add_option("--tokens", options.tokens, "The server's list")->required();
    command->add_flag("--json", options.is_json, "Result as JSON");
    if (command != listing) command->add_option("--user", options.user, "Whose")->required();
  }
  if (const std::optional<int> over = parse_command_line(app, argument_count, arguments, out, talk)) return *over;
  const Status done = adding->parsed() ? add(options, out) : listing->parsed() ? list(options, out) : revoke(options, out);
  if (done) return 0;
  complain(talk, app.get_name(), done.error().message);
  constexpr int kFailure = 1, kUsage = 2;
  return done.error().code == ErrorCode::kInvalidArgument ? kUsage : kFailure;
}

}  // namespace farfield
