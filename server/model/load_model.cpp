// SPDX-License-Identifier: Apache-2.0
#include "server/model/load_model.h"

#include <optional>
#include <string_view>

#include "server/model/clean_model.h"
#include "server/model/file_format.h"
#include "server/model/generate.h"
#include "server/model/import_process.h"
#include "server/model/text_lines.h"
#include "server/model/transparency.h"
#include "server/model/world_frame.h"

namespace farfield {
namespace {

struct GeneratedScene {
  std::string kind;
  std::size_t triangles = 0;
  std::uint64_t seed = 0;
};

/// All digits, or nothing.
std::optional<std::uint64_t> whole_number(std::string_view text) {
  if (text.empty() || text.find_first_not_of("0123456789") != text.npos) return std::nullopt;
  return parse_number<std::uint64_t>(text);
}

/// "kind:triangles:seed"; nothing if the argument does not look like it.
std::optional<GeneratedScene> parse_generated(std::string_view argument) {
  const std::size_t first = argument.find(':');
  if (first == argument.npos || first == 0) return std::nullopt;
  const std::size_t second = argument.find(':', first + 1);
  if (second == argument.npos) return std::nullopt;
  const auto triangles = whole_number(argument.substr(first + 1, second - first - 1));
  const auto seed = whole_number(argument.substr(second + 1));
  if (!triangles || !seed) return std::nullopt;
  return GeneratedScene{std::string(argument.substr(0, first)), static_cast<std::size_t>(*triangles), *seed};
}

/// Meant as a generated scene, if perhaps badly written: letters, a colon, no folder and no file name extension.
bool looks_generated(std::string_view argument) {
  const std::size_t colon = argument.find(':');
  constexpr std::string_view kLetters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ";
  return colon != argument.npos && argument.find_first_not_of(kLetters) == colon && argument.find('/') == argument.npos;
}

struct RawModel {
  Model model;
  const char* up = "y";
};

Result<RawModel> read_raw(const std::string& argument, const LoadOptions& options) {
  std::error_code ignored;
  const std::optional<GeneratedScene> generated = parse_generated(argument);
  if (generated && !std::filesystem::exists(argument, ignored)) {
    Result<Model> model = generate_model(generated->kind, generated->triangles, generated->seed);
    if (!model) return tl::unexpected(model.error());
    return RawModel{std::move(*model), "y"};
  }
  if (looks_generated(argument) && !std::filesystem::exists(argument, ignored)) {
    return fail(ErrorCode::kInvalidArgument,
                "{}: neither a file nor a scene to generate, which is written KIND:TRIANGLES:SEED with whole numbers, as "
                "in pipes:1000000:1",
                argument);
  }
  const Result<ModelFormat> format = find_model_format(argument);
  if (!format) return tl::unexpected(format.error());
  Result<Model> model = import_in_process(argument, {.program = options.import_program,
                                                     .memory_limit_bytes = options.memory_limit_bytes,
                                                     .time_limit = options.time_limit});
  if (!model) return tl::unexpected(model.error());
  return RawModel{std::move(*model), default_up_axis(*format)};
}

}  // namespace

Result<Model> load_model(const std::string& scene_argument, const LoadOptions& options) {
  if (scene_argument.empty())
    return fail(ErrorCode::kInvalidArgument, "no scene named; give a file or KIND:TRIANGLES:SEED");
  // Checked before the work, with any up axis: its own default is as good.
  const double units = options.metres_per_unit == 0 ? 1.0 : options.metres_per_unit;
  if (const auto frame = world_from_file(units, options.up.empty() ? "y" : options.up, options.shift); !frame) {
    return tl::unexpected(frame.error());
  }
  Result<RawModel> raw = read_raw(scene_argument, options);
  if (!raw) return tl::unexpected(raw.error());
  const Result<glm::dmat4> frame = world_from_file(units, options.up.empty() ? raw->up : options.up, options.shift);
  if (!frame) return tl::unexpected(frame.error());

  Model model = std::move(raw->model);
  for (MeshInstance& instance : model.instances) instance.world_from_mesh = *frame * instance.world_from_mesh;
  const bool had_triangles = model.drawn_triangles() > 0;
  settle_transparency(model);
  const bool is_all_clear = had_triangles && model.drawn_triangles() == 0;
  clean_model(model);
  drop_unused_materials(model);
  if (model.drawn_triangles() == 0) {
    const std::string why = is_all_clear    ? "every triangle is see-through"
                            : had_triangles ? "every triangle is broken"
                                            : "the file holds no triangles";
    const std::string detail = model.warnings.empty() ? "" : fmt::format(" ({})", model.warnings.back());
    return fail(ErrorCode::kBadData, "{}: nothing to show: {}{}; check the export", scene_argument, why, detail);
  }
  return model;
}

}  // namespace farfield
