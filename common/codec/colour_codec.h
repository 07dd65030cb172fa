// SPDX-License-Identifier: Apache-2.0
// Colour of a tile, less its surfaces' base colours: cosine transform of 8×8 blocks, quantised a little finer where
// eyes are keen, context-mixed coding.
//
// Why no library does this: a tile is a kilobyte or two, half of its blocks are covered in part only, and what is not
// covered may be anything. JPEG (tables of quality for the eye, no use of neighbours or coverage) takes twice the bytes at the same
// error; libaom's AV1 at its fastest as many on whole tiles and twice on packed ones; JPEG XL as many as JPEG.
#pragma once

#include "common/base/bytes.h"
#include "common/codec/tile_bits.h"

namespace farfield {

/// The quantiser's step for a quality of 1…100, in sRGB levels of an orthonormal transform, of middle frequencies.
float colour_step(int quality);

/// `rgb`: 3 bytes per sample of the tile, differences around 128. Uncovered samples are not kept.
/// `decoded`: if given, becomes what decode_colour() will return.
/// Requires: 1 <= quality <= 100.
Bytes encode_colour(ByteView rgb, const TileBits& bits, int quality, std::vector<std::uint8_t>* decoded = nullptr);
/// Uncovered samples get 128. Any bytes give some colours.
std::vector<std::uint8_t> decode_colour(ByteView bytes, const TileBits& bits, int quality);

}  // namespace farfield
