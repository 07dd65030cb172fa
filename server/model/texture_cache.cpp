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

/// Opacity of every texel of `mask`, as bytes.
std::vector<std::uint8_t> opacity_of(const TextureImage& mask, bool is_inverted) {
  std::vector<std::uint8_t> opacity(mask.rgba.size() / 4);
  bool has_alpha = false;
  for (std::size_t i = 0; i < opacity.size(); ++i) has_alpha = has_alpha || mask.rgba[4 * i + 3] != 255;
  for (std::size_t i = 0; i < opacity.size(); ++i) {
    const std::uint8_t* texel = mask.rgba.data() + 4 * i;
    const int value = has_alpha ? texel[3] : (texel[0] + texel[1] + texel[2] + 1) / 3;
    opacity[i] = static_cast<std::uint8_t>(is_inverted ? 255 - value : value);
  }
  return opacity;
}

/// `colour` with `opacity` of mask's size multiplied in, at the finer size of the two; nearest texels.
TextureImage combined(const TextureImage& colour, const TextureImage& mask, const std::vector<std::uint8_t>& opacity) {
  TextureImage image;
  image.width = std::max(colour.width, mask.width);
  image.height = std::max(colour.height, mask.height);
  image.rgba.resize(std::size_t{4} * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
  std::uint8_t* target = image.rgba.data();
  const auto place = [&](const TextureImage& from, int x, int y) {
    const std::int64_t column = std::int64_t{x} * from.width / image.width, row = std::int64_t{y} * from.height / image.height;
    return static_cast<std::size_t>(row * from.width + column);
  };
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x, target += 4) {
      std::copy_n(colour.rgba.data() + 4 * place(colour, x, y), 4, target);
      target[3] = static_cast<std::uint8_t>((target[3] * opacity[place(mask, x, y)] + 127) / 255);
    }
  }
  return image;
}

}  // namespace

std::filesystem::path TextureCache::find(const std::string& name) const {
  std::string cleaned = name;
  std::replace(cleaned.begin(), cleaned.end(), '\\', '/');
  std::error_code ignored;
  for (const std::string& variant : {name, cleaned, without_percent_codes(cleaned)}) {
    const std::filesystem::path path(variant);
    for (const std::filesystem::path& candidate : {folder_ / path, folder_ / path.filename()}) {
      model_.sources.push_back(candidate.string());
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

int TextureCache::masked(int texture, const std::string& mask_name, bool is_inverted) {
  const std::string key = fmt::format("{}{}\n{}", is_inverted ? "without " : "through ", mask_name, texture);
  if (const int index = known(key); index != -2) return index;
  const auto opaque = [&](const std::string& reason) {
    model_.warnings.push_back(fmt::format("opacity map {}: {}; drawn opaque", mask_name, reason));
    return index_by_name_[key] = texture;
  };
  const std::filesystem::path path = find(mask_name);
  if (path.empty()) return opaque("not found beside the model");
  const auto own = index_by_path_.find(path.string());
  if (texture >= 0 && own != index_by_path_.end() && own->second == texture && !is_inverted) return index_by_name_[key] = texture;
  const Result<TextureImage> mask = read_texture_file(path);
  if (!mask) return opaque(mask.error().message);
  const TextureImage white{.width = 1, .height = 1, .rgba = {255, 255, 255, 255}, .name = {}};
  const TextureImage& colour = texture < 0 ? white : model_.textures[static_cast<std::size_t>(texture)];
  TextureImage image = combined(colour, *mask, opacity_of(*mask, is_inverted));
  image.name = fmt::format("{} through {}", texture < 0 ? "white" : colour.name, mask->name);
  return add(key, std::move(image));
}

}  // namespace farfield
