// SPDX-License-Identifier: Apache-2.0
#include "server/model/mtl_reader.h"

#include <algorithm>
#include <cmath>

#include "server/model/text_lines.h"

namespace farfield {
namespace {

std::uint8_t to_byte(double value) {
  return static_cast<std::uint8_t>(std::lround(255 * std::clamp(value, 0.0, 1.0)));
}

/// The file name of a map statement: options ("-s 1 1 1", "-clamp on") and their values come before it.
std::string map_name(std::string_view rest) {
  std::string_view name = trimmed(rest);
  while (!name.empty() && name.front() == '-') {
    const std::string_view option = next_word(name);
    const bool takes_word = option == "-blendu" || option == "-blendv" || option == "-cc" || option == "-clamp" ||
                            option == "-imfchan" || option == "-type";
    if (takes_word) next_word(name);
    name = trimmed(name);
    for (std::string_view ahead = name; parse_number<double>(next_word(ahead)); name = trimmed(ahead)) {
      if (ahead.empty()) break;  // a file name that starts with a digit, and nothing behind it
    }
  }
  return std::string(name);
}

void set_opacity(Material& material, double opacity) {
  material.base_colour.a = to_byte(opacity);
  material.is_alpha_masked = material.base_colour.a != 255;
}

}  // namespace

void read_mtl(std::string_view text, Model& model, TextureCache& textures, std::map<std::string, int>& index_by_name) {
  struct OpacityMap {
    std::string name;
    bool is_inverted = false;
  };
  std::map<std::ptrdiff_t, std::string> colour_maps;  // by material
  std::map<std::ptrdiff_t, OpacityMap> opacity_maps;
  Material ignored;  // what stands before the first newmtl, or repeats a name
  Material* material = &ignored;
  std::string_view line;
  while (next_line(text, line)) {
    const std::string_view key = next_word(line);
    if (key == "newmtl") {
      const std::string name(trimmed(line));
      if (index_by_name.contains(name)) {
        material = &ignored;
        continue;
      }
      index_by_name[name] = static_cast<int>(model.materials.size());
      material = &model.materials.emplace_back();
      material->name = name;
    } else if (key == "Kd") {
      for (int c = 0; c < 3; ++c) {
        if (const auto value = parse_number<double>(next_word(line))) material->base_colour[c] = to_byte(*value);
      }
    } else if (key == "d") {
      std::string_view word = next_word(line);
      if (word == "-halo") word = next_word(line);
      if (const auto value = parse_number<double>(word)) set_opacity(*material, *value);
    } else if (key == "Tr") {
      if (const auto value = parse_number<double>(next_word(line))) set_opacity(*material, 1 - *value);
    } else if (key == "map_Kd") {
      if (material != &ignored) colour_maps[material - model.materials.data()] = map_name(line);
    } else if (key == "map_d" || key == "map_Tr") {
      if (material == &ignored) continue;
      opacity_maps[material - model.materials.data()] = {map_name(line), key == "map_Tr"};
    }
  }
  for (const auto& [index, name] : colour_maps) {
    model.materials[static_cast<std::size_t>(index)].texture = textures.index_of(name);
  }
  for (const auto& [index, map] : opacity_maps) {
    int& texture = model.materials[static_cast<std::size_t>(index)].texture;
    texture = textures.masked(texture, map.name, map.is_inverted);
  }
  // Many exporters write a black Kd beside a map; taken literally every such texture would be black.
  for (auto& [name, index] : index_by_name) {
    Material& m = model.materials[static_cast<std::size_t>(index)];
    if (m.texture < 0) continue;
    if (m.base_colour.r == 0 && m.base_colour.g == 0 && m.base_colour.b == 0)
      m.base_colour = {255, 255, 255, m.base_colour.a};
    m.is_alpha_masked = true;  // settle_transparency() keeps it only if the texture has holes
  }
}

}  // namespace farfield
