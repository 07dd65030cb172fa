// SPDX-License-Identifier: Apache-2.0
#include "server/model/import_report.h"

#include <sys/resource.h>

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>

#include "server/model/file_format.h"

namespace farfield {
namespace {

std::uint64_t peak_bytes(int who) {
  rusage usage{};
  return getrusage(who, &usage) == 0 ? static_cast<std::uint64_t>(usage.ru_maxrss) * 1024 : 0;
}

/// 1354234 as "1,354,234".
std::string grouped(std::size_t value) {
  std::string digits = std::to_string(value);
  for (std::size_t i = digits.size(); i > 3; i -= 3) digits.insert(i - 3, 1, ',');
  return digits;
}

}  // namespace

ImportReport make_import_report(const std::string& scene_argument, const Model& model, const LoadOptions& options,
                                double seconds) {
  ImportReport report;
  report.scene = scene_argument;
  report.drawn_triangles = model.drawn_triangles();
  for (const Mesh& mesh : model.meshes) report.stored_triangles += mesh.indices.size() / 3;
  report.meshes = model.meshes.size();
  report.instances = model.instances.size();
  report.materials = model.materials.size();
  report.textures = model.textures.size();
  for (const TextureImage& texture : model.textures) report.texture_texels += texture.rgba.size() / 4;
  report.bounds = model.bounds();
  report.is_units_given = options.metres_per_unit > 0;
  if (report.is_units_given) report.metres_per_unit = options.metres_per_unit;
  report.is_up_given = !options.up.empty();
  if (const auto format = find_model_format(scene_argument)) report.up = default_up_axis(*format);
  if (report.is_up_given) report.up = options.up;
  report.shift = options.shift;
  report.warnings = model.warnings;
  report.seconds = seconds;
  report.peak_memory_bytes = std::max(peak_bytes(RUSAGE_SELF), peak_bytes(RUSAGE_CHILDREN));
  return report;
}

std::string report_text(const ImportReport& report) {
  std::string text;
  auto out = std::back_inserter(text);
  const glm::dvec3 size = report.bounds.extent();
  fmt::format_to(out, "scene      {}\n", report.scene);
  fmt::format_to(out, "triangles  {} drawn, {} stored\n", grouped(report.drawn_triangles),
                 grouped(report.stored_triangles));
  fmt::format_to(out, "meshes     {} in {} instances\n", grouped(report.meshes), grouped(report.instances));
  fmt::format_to(out, "materials  {}\n", grouped(report.materials));
  fmt::format_to(out, "textures   {}, {:.1f} megatexels\n", grouped(report.textures),
                 1e-6 * static_cast<double>(report.texture_texels));
  fmt::format_to(out, "bounds     ({:.3f} {:.3f} {:.3f}) .. ({:.3f} {:.3f} {:.3f}) m\n", report.bounds.min.x,
                 report.bounds.min.y, report.bounds.min.z, report.bounds.max.x, report.bounds.max.y,
                 report.bounds.max.z);
  fmt::format_to(out, "size       {:.4g} x {:.4g} x {:.4g} m\n", size.x, size.y, size.z);
  fmt::format_to(out, "units      {} m{}\n", report.metres_per_unit,
                 report.is_units_given ? "" : " (assumed; --units changes it)");
  fmt::format_to(out, "up axis    {}{}\n", report.up, report.is_up_given ? "" : " (assumed; --up changes it)");
  if (report.shift != glm::dvec3(0))
    fmt::format_to(out, "shift      {} {} {} m\n", report.shift.x, report.shift.y, report.shift.z);
  fmt::format_to(out, "loaded in  {:.2f} s, peak memory {:.0f} MB\n", report.seconds,
                 1e-6 * static_cast<double>(report.peak_memory_bytes));
  if (report.warnings.empty()) return text + "warnings   none\n";
  constexpr std::size_t kShown = 12;
  for (std::size_t i = 0; i < std::min(kShown, report.warnings.size()); ++i) {
    fmt::format_to(out, "{}{}\n", i == 0 ? "warnings   " : "           ", report.warnings[i]);
  }
  if (report.warnings.size() > kShown)
    fmt::format_to(out, "           and {} more (all with --json)\n", report.warnings.size() - kShown);
  return text;
}

std::string report_json(const ImportReport& report) {
  const auto list = [](const glm::dvec3& v) { return nlohmann::ordered_json::array({v.x, v.y, v.z}); };
  nlohmann::ordered_json json;
  json["scene"] = report.scene;
  json["drawn_triangles"] = report.drawn_triangles;
  json["stored_triangles"] = report.stored_triangles;
  json["meshes"] = report.meshes;
  json["instances"] = report.instances;
  json["materials"] = report.materials;
  json["textures"] = report.textures;
  json["texture_texels"] = report.texture_texels;
  json["bounds_min_m"] = list(report.bounds.min);
  json["bounds_max_m"] = list(report.bounds.max);
  json["metres_per_unit"] = report.metres_per_unit;
  json["up"] = report.up;
  json["shift_m"] = list(report.shift);
  json["warnings"] = report.warnings;
  json["seconds"] = report.seconds;
  json["peak_memory_bytes"] = report.peak_memory_bytes;
  // Names in files may be in any encoding: what is not UTF-8 is replaced.
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace farfield
