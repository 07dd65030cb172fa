// SPDX-License-Identifier: Apache-2.0
#include "server/model/gltf_claims.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "server/model/file_bytes.h"

namespace farfield {
namespace {

using Json = nlohmann::json;

/// A member that must be a number not below zero; `missing` where it is absent or anything else.
double number_of(const Json& json, const char* key, double missing) {
  const auto found = json.is_object() ? json.find(key) : json.end();
  if (!json.is_object() || found == json.end() || !found->is_number()) return missing;
  return found->get<double>();
}

const Json& list_of(const Json& json, const char* key) {
  static const Json kEmpty = Json::array();
  const auto found = json.find(key);
  return found != json.end() && found->is_array() ? *found : kEmpty;
}

double element_bytes(const Json& accessor) {
  const double component_type = number_of(accessor, "componentType", 5126);
  const double component = component_type <= 5121 ? 1 : component_type <= 5123 ? 2 : 4;
  const auto found = accessor.find("type");
  const std::string type = found != accessor.end() && found->is_string() ? found->get<std::string>() : "SCALAR";
  const double count = type == "VEC2"                     ? 2
                       : type == "VEC3"                   ? 3
                       : type == "VEC4" || type == "MAT2" ? 4
                       : type == "MAT3"                   ? 9
                       : type == "MAT4"                   ? 16
                                                          : 1;
  return component * count;
}

Status check_accessors(const std::filesystem::path& path, const Json& root) {
  const Json& views = list_of(root, "bufferViews");
  std::size_t number = 0;
  for (const Json& accessor : list_of(root, "accessors")) {
    const double count = number_of(accessor, "count", 0);
    const double view_index = number_of(accessor, "bufferView", -1);
    const bool has_view = view_index >= 0 && view_index < static_cast<double>(views.size());
    const Json& view = has_view ? views[static_cast<std::size_t>(view_index)] : accessor;
    const double there = has_view ? number_of(view, "byteLength", 0) - number_of(accessor, "byteOffset", 0) : 0;
    const double element = element_bytes(accessor);
    const double stride = std::max(has_view ? number_of(view, "byteStride", element) : element, 1.0);
    const double needed = count > 0 ? stride * (count - 1) + element : 0;
    // Accessors without a view stand for zeros: there is nothing to hold them against but common sense.
    if (has_view ? needed > there : count > 1e8) {
      return fail(ErrorCode::kBadData,
                  "{}: accessor {} claims {:.0f} elements ({:.0f} bytes) but its buffer view holds {:.0f}; export the "
                  "file again",
                  path.string(), number, count, needed, std::max(there, 0.0));
    }
    ++number;
  }
  return {};
}

Status check_buffers(const std::filesystem::path& path, const Json& root, double binary_chunk_bytes) {
  for (const Json& buffer : list_of(root, "buffers")) {
    const double claimed = number_of(buffer, "byteLength", 0);
    const auto uri = buffer.is_object() ? buffer.find("uri") : buffer.end();
    if (!buffer.is_object() || uri == buffer.end() || !uri->is_string()) {
      if (claimed > binary_chunk_bytes) {
        return fail(ErrorCode::kBadData,
                    "{}: a buffer claims {:.0f} bytes but the file brings {:.0f}; it is truncated: copy it again",
                    path.string(), claimed, binary_chunk_bytes);
      }
      continue;
    }
    const std::string& name = uri->get_ref<const std::string&>();
    if (name.starts_with("data:")) {
      if (claimed > 0.75 * static_cast<double>(name.size())) {
        return fail(ErrorCode::kBadData,
                    "{}: an embedded buffer claims {:.0f} bytes, more than its text holds; export the file again",
                    path.string(), claimed);
      }
      continue;
    }
    std::error_code error;
    const auto size = std::filesystem::file_size(path.parent_path() / name, error);
    if (error && name.find('%') == name.npos) {
      return fail(ErrorCode::kNotFound, "{}: its data file {} is not beside it; copy both", path.string(), name);
    }
    if (!error && claimed > static_cast<double>(size)) {
      return fail(ErrorCode::kBadData, "{}: needs {:.0f} bytes of {}, which has {}; copy both files again",
                  path.string(), claimed, name, size);
    }
  }
  return {};
}

/// Triangles that the index lists (or vertex lists) of all primitives add up to; strips and fans have two fewer than
/// corners.
std::size_t announced_triangles(const Json& root) {
  const Json& accessors = list_of(root, "accessors");
  const auto count_of = [&](double index) {
    return index >= 0 && index < static_cast<double>(accessors.size())
               ? number_of(accessors[static_cast<std::size_t>(index)], "count", 0)
               : 0.0;
  };
  double triangles = 0;
  for (const Json& mesh : list_of(root, "meshes")) {
    if (!mesh.is_object()) continue;
    for (const Json& primitive : list_of(mesh, "primitives")) {
      if (!primitive.is_object()) continue;
      const double mode = number_of(primitive, "mode", 4);
      const double indices = number_of(primitive, "indices", -1);
      const auto attributes = primitive.find("attributes");
      const double positions = attributes == primitive.end() ? -1 : number_of(*attributes, "POSITION", -1);
      const double corners = count_of(indices >= 0 ? indices : positions);
      if (mode == 4) triangles += std::floor(corners / 3);
      if (mode == 5 || mode == 6) triangles += std::max(corners - 2, 0.0);
    }
  }
  return static_cast<std::size_t>(std::clamp(triangles, 0.0, 1e15));
}

}  // namespace

Result<FileClaims> check_gltf_claims(const std::filesystem::path& path, ModelFormat format) {
  const Result<Bytes> bytes = read_file_bytes(path);
  if (!bytes) return tl::unexpected(bytes.error());
  ByteView json_text = *bytes;
  double binary_bytes = 0;
  if (format == ModelFormat::kGlb) {
    ByteReader reader(*bytes);
    reader.get<std::uint32_t>();  // "glTF", seen by find_model_format()
    const auto version = reader.get<std::uint32_t>(), length = reader.get<std::uint32_t>();
    const auto json_length = reader.get<std::uint32_t>();
    reader.get<std::uint32_t>();  // chunk type
    json_text = reader.get_bytes(json_length);
    if (reader.ok() && version != 2) {
      return fail(ErrorCode::kBadData, "{}: glTF version {}; only version 2 is read: convert it", path.string(),
                  version);
    }
    if (!reader.ok() || length > bytes->size()) {
      return fail(ErrorCode::kBadData,
                  "{}: the header claims {} bytes but the file has {}; it is truncated: copy it again", path.string(),
                  length, bytes->size());
    }
    const auto chunk_bytes = reader.get<std::uint32_t>();
    if (reader.ok()) binary_bytes = std::min<double>(chunk_bytes, static_cast<double>(reader.remaining()));
  }
  const Json root = Json::parse(json_text, nullptr, false);
  if (root.is_discarded() || !root.is_object()) {
    return fail(ErrorCode::kBadData, "{}: its glTF description is not JSON; check what the file really is",
                path.string());
  }
  Status status = check_buffers(path, root, binary_bytes);
  if (status) status = check_accessors(path, root);
  if (!status) return tl::unexpected(status.error());
  return FileClaims{announced_triangles(root)};
}

}  // namespace farfield
