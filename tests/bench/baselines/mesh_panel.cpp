// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/baselines/mesh_panel.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>

#include "common/impostor/fill_uncovered.h"

namespace farfield::bench {
namespace {

/// A multiple of four bytes, as meshoptimizer's codec wants it.
struct CodedVertex {
  std::uint16_t column = 0, row = 0;  // in half samples
  std::uint16_t disparity = 0;        // in steps
  std::uint16_t unused = 0;
};

Bytes encode_mesh(const FaceMesh& mesh, double step) {
  std::vector<CodedVertex> coded(mesh.vertices.size());
  std::transform(mesh.vertices.begin(), mesh.vertices.end(), coded.begin(), [&](const FaceVertex& v) {
    return CodedVertex{static_cast<std::uint16_t>(std::lround(2 * v.column)), static_cast<std::uint16_t>(std::lround(2 * v.row)),
                       static_cast<std::uint16_t>(std::min(65535L, std::lround(v.disparity / step))), 0};
  });
  Bytes vertices(meshopt_encodeVertexBufferBound(coded.size(), sizeof(CodedVertex)));
  vertices.resize(meshopt_encodeVertexBuffer(vertices.data(), vertices.size(), coded.data(), coded.size(), sizeof(CodedVertex)));
  Bytes indices(meshopt_encodeIndexBufferBound(mesh.indices.size(), coded.size()));
  indices.resize(meshopt_encodeIndexBuffer(indices.data(), indices.size(), mesh.indices.data(), mesh.indices.size()));
  ByteWriter out;
  out.put_varint(coded.size());
  out.put_varint(mesh.triangles());
  out.put_varint(vertices.size());
  out.put_bytes(vertices);
  out.put_bytes(indices);
  return compress(out.bytes());
}

Result<FaceMesh> decode_mesh(ByteView bytes, int edge, double step) {
  // A triangle of each half of each sample, generously coded.
  const std::size_t samples = static_cast<std::size_t>(edge) * static_cast<std::size_t>(edge);
  const Result<Bytes> raw = decompress(bytes, 64 * samples + 1024);
  if (!raw) return tl::unexpected(raw.error());
  ByteReader in(*raw);
  const std::uint64_t vertex_count = in.get_varint(), triangle_count = in.get_varint();
  const ByteView vertices = in.get_bytes(in.get_varint());
  const ByteView indices = in.get_bytes(in.remaining());
  if (!in.ok() || vertex_count > 4 * (samples + 4 * static_cast<std::size_t>(edge)) || triangle_count > 2 * samples)
    return fail(ErrorCode::kBadData, "baseline mesh: more than its face can hold");
  std::vector<CodedVertex> coded(vertex_count);
  FaceMesh mesh;
  mesh.indices.resize(3 * triangle_count);
  if (meshopt_decodeVertexBuffer(coded.data(), coded.size(), sizeof(CodedVertex), vertices.data(), vertices.size()) != 0 ||
      meshopt_decodeIndexBuffer(mesh.indices.data(), mesh.indices.size(), sizeof(std::uint32_t), indices.data(), indices.size()) != 0 ||
      std::any_of(mesh.indices.begin(), mesh.indices.end(), [&](std::uint32_t i) { return i >= vertex_count; }))
    return fail(ErrorCode::kBadData, "baseline mesh: not what was encoded");
  for (const CodedVertex& v : coded)
    mesh.vertices.push_back({0.5f * static_cast<float>(v.column), 0.5f * static_cast<float>(v.row), static_cast<float>(v.disparity * step)});
  return mesh;
}

}  // namespace

std::vector<std::uint8_t> blocks_under(const FaceMesh& mesh, int edge) {
  const int along = blocks_along(edge);
  std::vector<std::uint8_t> wanted(static_cast<std::size_t>(along) * static_cast<std::size_t>(along), 0);
  for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
    const FaceVertex &a = mesh.vertices[mesh.indices[t]], &b = mesh.vertices[mesh.indices[t + 1]], &c = mesh.vertices[mesh.indices[t + 2]];
    // Bilinear filtering reaches half a sample farther on either side.
    const auto [low_x, high_x] = std::minmax({a.column, b.column, c.column});
    const auto [low_y, high_y] = std::minmax({a.row, b.row, c.row});
    const auto block = [&](float sample) { return std::clamp(static_cast<int>(std::floor(sample)) / kImageBlock, 0, along - 1); };
    for (int y = block(low_y - 0.5f); y <= block(high_y + 0.5f); ++y)
      for (int x = block(low_x - 0.5f); x <= block(high_x + 0.5f); ++x) wanted[static_cast<std::size_t>(y * along + x)] = 1;
  }
  return wanted;
}

Result<EncodedPanel> encode_panel(const MeshPanel& panel, const PanelEncoding& encoding) {
  EncodedPanel result;
  if (panel.mesh.indices.empty()) return result;  // no bytes at all
  const Result<Bytes> image = encode_image_blocks(panel.rgb, panel.frame.edge_samples, panel.wanted, encoding.jpeg_quality);
  if (!image) return tl::unexpected(image.error());
  result.image = *image;
  result.mesh = encode_mesh(panel.mesh, encoding.disparity_step);
  return result;
}

Result<MeshPanel> decode_panel(const ViewFrame& frame, int face, const EncodedPanel& bytes, const PanelEncoding& encoding) {
  MeshPanel panel{frame, face, {}, {}, {}};
  if (bytes.mesh.empty()) return panel;
  Result<FaceMesh> mesh = decode_mesh(bytes.mesh, frame.edge_samples, encoding.disparity_step);
  if (!mesh) return tl::unexpected(mesh.error());
  panel.mesh = std::move(*mesh);
  const Result<std::vector<std::uint8_t>> sent = decode_image_blocks(bytes.image, frame.edge_samples, encoding.jpeg_quality, panel.rgb);
  if (!sent) return tl::unexpected(sent.error());
  fill_uncovered(panel.rgb, *sent, frame.edge_samples, frame.edge_samples);
  return panel;
}

}  // namespace farfield::bench
