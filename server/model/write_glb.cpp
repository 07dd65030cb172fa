// SPDX-License-Identifier: Apache-2.0
#include "server/model/write_glb.h"

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "common/shading/shading.h"
#include "common/base/complete_file.h"
#include "server/model/texture_file.h"

namespace farfield {
namespace {

using Json = nlohmann::ordered_json;

// glTF 2.0 numbers
constexpr int kUnsignedInt = 5125, kFloat = 5126, kUnsignedShort = 5123;
constexpr int kArrayBuffer = 34962, kElementArrayBuffer = 34963;
constexpr int kRepeat = 10497, kLinear = 9729, kLinearMipmapLinear = 9987;

using Colour16 = std::array<std::uint16_t, 4>;

std::vector<Colour16> linear_colours(const std::vector<glm::u8vec4>& colours) {
  std::vector<Colour16> result;
  result.reserve(colours.size());
  for (const glm::u8vec4& c : colours) {
    Colour16 linear{};
    for (int k = 0; k < 3; ++k)
      linear[static_cast<std::size_t>(k)] = static_cast<std::uint16_t>(std::lround(65535 * srgb_to_linear(c[k])));
    linear[3] = static_cast<std::uint16_t>(c.a * 257);
    result.push_back(linear);
  }
  return result;
}

std::uint64_t padded(std::uint64_t size) {
  return (size + 3) & ~std::uint64_t{3};
}

/// Lays out the binary chunk and describes it; the bytes follow in the same order when they are written.
class GlbDescription {
 public:
  GlbDescription(const Model& model, const std::vector<Bytes>& pngs) : model_(model), pngs_(pngs) {
    json_["asset"] = {{"version", "2.0"}, {"generator", "farfield"}};
    json_["scene"] = 0;
    describe_textures();
    describe_materials();
    for (const Mesh& mesh : model.meshes) describe_mesh(mesh);
    describe_instances();
    json_["buffers"] = Json::array({{{"byteLength", binary_bytes_}}});
  }

  std::uint64_t binary_bytes() const { return binary_bytes_; }
  std::string text() const {
    std::string text = json_.dump(-1, ' ', false, Json::error_handler_t::replace);
    text.resize(static_cast<std::size_t>(padded(text.size())), ' ');
    return text;
  }

 private:
  std::size_t add_view(std::uint64_t bytes, int target) {
    Json view = {{"buffer", 0}, {"byteOffset", binary_bytes_}, {"byteLength", bytes}};
    if (target != 0) view["target"] = target;
    binary_bytes_ += padded(bytes);
    json_["bufferViews"].push_back(std::move(view));
    return json_["bufferViews"].size() - 1;
  }

  std::size_t add_accessor(std::size_t count, std::size_t element_bytes, int component, const char* type, int target) {
    Json accessor = {{"bufferView", add_view(count * element_bytes, target)},
                     {"componentType", component},
                     {"count", count},
                     {"type", type}};
    json_["accessors"].push_back(std::move(accessor));
    return json_["accessors"].size() - 1;
  }

  void describe_textures() {
    if (pngs_.empty()) return;
    json_["samplers"] = Json::array(
        {{{"magFilter", kLinear}, {"minFilter", kLinearMipmapLinear}, {"wrapS", kRepeat}, {"wrapT", kRepeat}}});
    for (std::size_t i = 0; i < pngs_.size(); ++i) {
      const std::size_t view = add_view(pngs_[i].size(), 0);  // first: adding a member may move the others
      json_["images"].push_back({{"name", model_.textures[i].name}, {"mimeType", "image/png"}, {"bufferView", view}});
      json_["textures"].push_back({{"sampler", 0}, {"source", i}});
    }
  }

  void describe_materials() {
    for (const Material& material : model_.materials) {
      const glm::u8vec4 c = material.base_colour;
      Json surface = {{"baseColorFactor", {srgb_to_linear(c.r), srgb_to_linear(c.g), srgb_to_linear(c.b), c.a / 255.0}},
                      {"metallicFactor", 0},
                      {"roughnessFactor", 1}};
      if (material.texture >= 0) surface["baseColorTexture"] = {{"index", material.texture}};
      Json json = {{"name", material.name}, {"pbrMetallicRoughness", std::move(surface)}, {"doubleSided", true}};
      if (material.is_alpha_masked) {
        json["alphaMode"] = "MASK";
        json["alphaCutoff"] = material.alpha_cutoff;
      }
      json_["materials"].push_back(std::move(json));
    }
  }

  void describe_mesh(const Mesh& mesh) {
    const std::size_t count = mesh.positions.size();
    Json attributes;
    const std::size_t position = add_accessor(count, sizeof(glm::vec3), kFloat, "VEC3", kArrayBuffer);
    glm::vec3 low(mesh.positions.empty() ? glm::vec3(0) : mesh.positions[0]), high(low);
    for (const glm::vec3& p : mesh.positions) low = glm::min(low, p), high = glm::max(high, p);
    json_["accessors"][position]["min"] = {low.x, low.y, low.z};
    json_["accessors"][position]["max"] = {high.x, high.y, high.z};
    attributes["POSITION"] = position;
    if (!mesh.normals.empty())
      attributes["NORMAL"] = add_accessor(count, sizeof(glm::vec3), kFloat, "VEC3", kArrayBuffer);
    if (!mesh.uvs.empty())
      attributes["TEXCOORD_0"] = add_accessor(count, sizeof(glm::vec2), kFloat, "VEC2", kArrayBuffer);
    if (!mesh.colours.empty()) {
      const std::size_t colour = add_accessor(count, sizeof(Colour16), kUnsignedShort, "VEC4", kArrayBuffer);
      json_["accessors"][colour]["normalized"] = true;
      attributes["COLOR_0"] = colour;
    }
    const std::size_t indices = add_accessor(mesh.indices.size(), 4, kUnsignedInt, "SCALAR", kElementArrayBuffer);
    Json primitive = {{"attributes", std::move(attributes)}, {"indices", indices}, {"material", mesh.material}};
    json_["meshes"].push_back({{"name", mesh.name}, {"primitives", Json::array({std::move(primitive)})}});
  }

  void describe_instances() {
    Json roots = Json::array();
    for (std::size_t i = 0; i < model_.instances.size(); ++i) {
      const glm::dmat4& m = model_.instances[i].world_from_mesh;
      Json node = {{"mesh", model_.instances[i].mesh}};
      glm::dmat4 translation(1);
      translation[3] = m[3];
      if (m == translation) {  // set, never computed: equality is meant
        if (m != glm::dmat4(1)) node["translation"] = {m[3].x, m[3].y, m[3].z};
      } else {
        Json matrix = Json::array();
        for (int c = 0; c < 4; ++c) {
          for (int r = 0; r < 4; ++r) matrix.push_back(m[c][r]);
        }
        node["matrix"] = std::move(matrix);
      }
      json_["nodes"].push_back(std::move(node));
      roots.push_back(i);
    }
    json_["scenes"] = Json::array({{{"name", model_.name}, {"nodes", std::move(roots)}}});
  }

  const Model& model_;
  const std::vector<Bytes>& pngs_;
  Json json_;
  std::uint64_t binary_bytes_ = 0;
};

class GlbWriter {
 public:
  explicit GlbWriter(CompleteFile& file) : file_(file) {}

  template <class T>
  void put(const std::vector<T>& values) {
    const ByteView bytes(reinterpret_cast<const std::uint8_t*>(values.data()), values.size() * sizeof(T));
    file_.write(bytes);
    constexpr std::uint8_t kZeros[4] = {};
    file_.write({kZeros, static_cast<std::size_t>(padded(bytes.size()) - bytes.size())});
  }

 private:
  CompleteFile& file_;
};

void write_header(CompleteFile& file, std::string_view json, std::uint64_t binary_bytes) {
  ByteWriter header;
  header.put<std::uint32_t>(0x46546c67);  // "glTF"
  header.put<std::uint32_t>(2);
  header.put<std::uint32_t>(static_cast<std::uint32_t>(12 + 8 + json.size() + 8 + binary_bytes));
  header.put<std::uint32_t>(static_cast<std::uint32_t>(json.size()));
  header.put<std::uint32_t>(0x4e4f534a);  // "JSON"
  header.put_bytes({reinterpret_cast<const std::uint8_t*>(json.data()), json.size()});
  header.put<std::uint32_t>(static_cast<std::uint32_t>(binary_bytes));
  header.put<std::uint32_t>(0x004e4942);  // "BIN"
  file.write(header.bytes());
}

}  // namespace

Status write_glb(const Model& model, const std::filesystem::path& path) {
  if (model.drawn_triangles() == 0)
    return fail(ErrorCode::kInvalidArgument, "{}: the model has no triangles to write", path.string());
  std::vector<Bytes> pngs;
  for (const TextureImage& texture : model.textures) {
    Result<Bytes> png = encode_png(texture);
    if (!png) return fail_within(path.string(), png.error());
    pngs.push_back(std::move(*png));
  }
  const GlbDescription description(model, pngs);
  const std::string json = description.text();
  constexpr std::uint64_t kMaxGlbBytes = 0xffffffffu;  // lengths are 32 bits
  if (28 + json.size() + description.binary_bytes() > kMaxGlbBytes) {
    return fail(ErrorCode::kLimitExceeded, "{}: {} MB, more than the 4 GB a GLB file can hold; write fewer triangles",
                path.string(), description.binary_bytes() >> 20);
  }

  Result<CompleteFile> file = CompleteFile::create(path);
  if (!file) return tl::unexpected(file.error());
  write_header(*file, json, description.binary_bytes());
  GlbWriter writer(*file);
  for (const Bytes& png : pngs) writer.put(png);
  for (const Mesh& mesh : model.meshes) {  // the order of GlbDescription::describe_mesh()
    writer.put(mesh.positions);
    if (!mesh.normals.empty()) writer.put(mesh.normals);
    if (!mesh.uvs.empty()) writer.put(mesh.uvs);
    if (!mesh.colours.empty()) writer.put(linear_colours(mesh.colours));
    writer.put(mesh.indices);
  }
  return file->commit();
}

}  // namespace farfield
