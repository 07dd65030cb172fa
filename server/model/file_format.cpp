// SPDX-License-Identifier: Apache-2.0
#include "server/model/file_format.h"

#include <algorithm>
#include <cctype>
#include <string_view>

#include "server/model/file_bytes.h"

namespace farfield {
namespace {

struct Extension {
  std::string_view extension;
  ModelFormat format;
};

constexpr Extension kExtensions[] = {
    {".obj", ModelFormat::kObj},           {".json", ModelFormat::kCityJson}, {".jsonl", ModelFormat::kCityJson},
    {".cityjson", ModelFormat::kCityJson}, {".glb", ModelFormat::kGlb},       {".gltf", ModelFormat::kGltf},
    {".ply", ModelFormat::kPly},           {".stl", ModelFormat::kStl},       {".off", ModelFormat::kOff},
    {".dae", ModelFormat::kCollada},       {".ac", ModelFormat::kAc3d},       {".ifc", ModelFormat::kIfc},
};

/// What the first bytes must be, where a format says so.
std::string_view signature_of(ModelFormat format) {
  switch (format) {
    case ModelFormat::kGlb: return "glTF";
    case ModelFormat::kPly: return "ply";
    case ModelFormat::kAc3d: return "AC3D";
    case ModelFormat::kIfc: return "ISO-10303-21";
    default: return "";
  }
}

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

}  // namespace

const char* model_format_name(ModelFormat format) {
  switch (format) {
    case ModelFormat::kObj: return "Wavefront OBJ";
    case ModelFormat::kCityJson: return "CityJSON";
    case ModelFormat::kGlb: return "binary glTF";
    case ModelFormat::kGltf: return "glTF";
    case ModelFormat::kPly: return "PLY";
    case ModelFormat::kStl: return "STL";
    case ModelFormat::kOff: return "OFF";
    case ModelFormat::kCollada: return "COLLADA";
    case ModelFormat::kAc3d: return "AC3D";
    case ModelFormat::kIfc: return "IFC";
  }
  return "unknown";
}

const char* default_up_axis(ModelFormat format) {
  return format == ModelFormat::kCityJson ? "z" : "y";
}

Result<ModelFormat> find_model_format(const std::filesystem::path& path) {
  const Result<Bytes> start = read_file_start(path, 64);
  if (!start) return tl::unexpected(start.error());
  const std::string_view text(reinterpret_cast<const char*>(start->data()), start->size());
  if (text.starts_with("\x1f\x8b") || text.starts_with("PK\x03\x04")) {
    return fail(ErrorCode::kBadData, "{}: the file is compressed; unpack it first", path.string());
  }
  const std::string extension = lower(path.extension().string());
  const auto found = std::find_if(std::begin(kExtensions), std::end(kExtensions),
                                  [&](const Extension& e) { return e.extension == extension; });
  if (found == std::end(kExtensions)) {
    return fail(ErrorCode::kBadData,
                "{}: unknown kind of file '{}'; use .glb .gltf .obj .ply .stl .off .dae .ac .ifc or .city.json",
                path.string(), extension);
  }
  const std::string_view signature = signature_of(found->format);
  const std::string_view content = text.starts_with("\xef\xbb\xbf") ? text.substr(3) : text;
  if (!content.starts_with(signature)) {
    return fail(ErrorCode::kBadData, "{}: not a {} file (it does not start with '{}'); check what it really is",
                path.string(), model_format_name(found->format), signature);
  }
  return found->format;
}

}  // namespace farfield
