// SPDX-License-Identifier: Apache-2.0
// The compact binary form in which the import process hands a model to its parent. Private to one build of Farfield:
// both ends are the same version on the same machine, so numbers are memory images and there is no migration.
//
// Layout, little-endian: "FFMODEL2"; name; warnings; sources; textures; materials; meshes; instances. A list is a u64 count and
// its entries; a text or an array is a u64 count and its bytes or elements.
#pragma once

#include "common/base/bytes.h"
#include "common/base/result.h"
#include "server/model/model.h"

namespace farfield {

/// Writes to an open file from its current place, buffered. Errors: kIo.
Status write_model_stream(const Model& model, int file_descriptor);

/// Any bytes are safe: counts are checked against what is left before memory is taken, and afterwards every mesh,
/// material and texture number is in range and per-vertex arrays are empty or as long as positions. Vertex indices,
/// positions and transforms may still be anything: clean_model() judges them. Errors: kBadData.
Result<Model> read_model_stream(ByteView bytes);

}  // namespace farfield
