// SPDX-License-Identifier: Apache-2.0
// Who may do what. Without a list of tokens there are no roles: everybody may walk, nobody may operate.
#pragma once

#include <array>
#include <optional>
#include <string_view>

namespace farfield {

/// Each may do what those before it may.
enum class Role { kViewer, kReviewer, kAdmin };
enum class Action {
  kView,     // walk through a scene
  kReview,   // leave marks that others see
  kOperate,  // drain the server
};

inline constexpr std::array<std::string_view, 3> kRoleNames{"viewer", "reviewer", "admin"};

constexpr std::string_view role_name(Role role) { return kRoleNames[static_cast<std::size_t>(role)]; }

constexpr std::optional<Role> parse_role(std::string_view name) {
  for (std::size_t i = 0; i < kRoleNames.size(); ++i) {
    if (kRoleNames[i] == name) return static_cast<Role>(i);
  }
  return std::nullopt;
}

constexpr bool allows(Role role, Action action) { return static_cast<int>(role) >= static_cast<int>(action); }

}  // namespace farfield
