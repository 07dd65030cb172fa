// SPDX-License-Identifier: Apache-2.0
#include "server/model/texture_cache.h"

#include <algorithm>
#include <charconv>

#include "server/model/texture_file.h"

namespace farfield {
namespace {

std::string without_percent_codes(const std::string& name) {
  std::string result;
  for (std::size_t i = 0; i < name.size(); ++i) {
    unsigned code = 0;
    if (name[i] == '%' && i + 2 < name.size() &&
        std::from_chars(&name[i + 1], &name[i + 3], code, 16).ptr == &name[i + 3]) {
      result.push_back(static_cast<char>(code));
      i += 2;
    } else {
      result.push_back(name[i]);
    }
  }
  return result;
}

}  // namespace

std::filesystem::path TextureCache::find(const std::string& name) const {
  std::string cleaned = name;
  std::replace(cleaned.begin(), cleaned.end(), '\\', '/');
  std::error_code ignored;
  for (const std::string& variant : {name, cleaned, without_percent_codes(cleaned)}) {
    const std::filesystem::path path(variant);
    for (const std::filesystem::path& candidate : {folder_ / path, folder_ / path.filename()}) {
      if (std::filesystem::is_regular_file(candidate, ignored)) return candidate;
    }
  }
  return {};
}

int TextureCache::known(const std::string& name) const {
  const auto found = index_by_name_.find(name);
  return found == index_by_name_.end() ? -2 : found->second;
}

int TextureCache::add(const std::string& name, TextureImage image) {
  const int index = static_cast<int>(model_.textures.size());
  if (image.name.empty()) image.name = name;
  model_.textures.push_back(std::move(image));
  return index_by_name_[name] = index;
}

int TextureCache::reject(const std::string& name, const std::string& reason) {
  model_.warnings.push_back(fmt::format("texture {}: {}; drawn white", name, reason));
  return index_by_name_[name] = -1;
}

int TextureCache::index_of(const std::string& name) {
  if (const int index = known(name); index != -2) return index;
  const std::filesystem::path path = find(name);
  if (path.empty()) return reject(name, "not found beside the model");
  if (const auto found = index_by_path_.find(path.string()); found != index_by_path_.end()) {
    return index_by_name_[name] = found->second;
  }
  Result<TextureImage> image = read_texture_file(path);
  const int index = image ? add(name, std::move(*image)) : reject(name, image.error().message);
  return index_by_path_[path.string()] = index;
}

}  // namespace farfield
