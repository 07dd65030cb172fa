// SPDX-License-Identifier: Apache-2.0
// A textured mesh for one face of one view: what billboards, TDMs and ITDMs are made of, how they are encoded, and what a
// client gets.
//
// Encoded as the papers leave open and as Farfield would do it: vertices quantised and sorted, meshoptimizer's vertex and
// index codecs, then zstd; images as arithmetic-coded JPEG 4:4:4 (tests/bench/baselines/jpeg_image.h), of delta samples only the
// blocks that their mesh shows.
#pragma once

#include "common/base/bytes.h"
#include "common/base/result.h"
#include "tests/bench/baselines/face_mesh.h"

namespace farfield::bench {

struct MeshPanel {
  ViewFrame frame;
  int face = 0;
  FaceMesh mesh;
  std::vector<std::uint8_t> rgb;     // sRGB, edge × edge
  std::vector<std::uint8_t> wanted;  // blocks_along(edge)² blocks that are sent; empty: all
};

/// Blocks of the image that are sent or left out as a whole: JPEG's own.
inline constexpr int kImageBlock = 8;
inline int blocks_along(int edge) { return (edge + kImageBlock - 1) / kImageBlock; }

/// The blocks that filtering within a mesh's triangles can touch.
std::vector<std::uint8_t> blocks_under(const FaceMesh& mesh, int edge);

struct PanelEncoding {
  int jpeg_quality = 76;
  double disparity_step = 1e-3;  // 1/side; vertices move by half of it
};
struct EncodedPanel {
  Bytes mesh, image;
  std::size_t size() const { return mesh.size() + image.size(); }
};

/// Requires: columns and rows are multiples of ½; a disparity below 65535 steps. Errors: kInternal (library).
Result<EncodedPanel> encode_panel(const MeshPanel& panel, const PanelEncoding& encoding);
/// What a client draws: `panel.frame` and `face` are known from the cell, the rest comes from the bytes. Blocks that were
/// not sent continue their neighbours. Errors: kBadData.
Result<MeshPanel> decode_panel(const ViewFrame& frame, int face, const EncodedPanel& bytes, const PanelEncoding& encoding);

/// Image blocks alone, for layered depth images as well. `rgb`: edge × edge; `wanted` as in MeshPanel.
Result<Bytes> encode_image_blocks(std::span<const std::uint8_t> rgb, int edge, std::span<const std::uint8_t> wanted, int quality);
/// `rgb` is resized; returns which samples were sent.
Result<std::vector<std::uint8_t>> decode_image_blocks(ByteView bytes, int edge, int quality, std::vector<std::uint8_t>& rgb);

/// zstd with the size in front.
Bytes compress(ByteView bytes);
/// Errors: kBadData, or more than `limit` bytes.
Result<Bytes> decompress(ByteView bytes, std::size_t limit);

}  // namespace farfield::bench
