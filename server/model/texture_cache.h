// SPDX-License-Identifier: Apache-2.0
// Textures by the name a model calls them: each file is found, read and stored once, however many materials use it.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "server/model/model.h"

namespace farfield {

/// Adds textures and warnings to the model it was given, which must outlive it. One thread.
class TextureCache {
 public:
  TextureCache(Model& model, std::filesystem::path folder) : model_(model), folder_(std::move(folder)) {}

  /// Index of the texture in the model, or -1 with one warning per name if it is missing or cannot be read: the
  /// material is then drawn white. Back slashes, "%20" and paths of the author's machine are tolerated: a file of the
  /// same name beside the model is taken.
  int index_of(const std::string& name);

  /// The texture (-1: plain white) with the opacity of an image of its own, as MTL's map_d has it: the image's alpha if
  /// it has any, else its brightness. Returns: `texture` itself, with a warning, if there is no such image, and where
  /// the image is the texture's own file, whose alpha it has already.
  int masked(int texture, const std::string& mask_name, bool is_inverted);

  /// Stores an image that did not come from a file, under a name of its own.
  int add(const std::string& name, TextureImage image);
  /// Remembers that `name` cannot be used. Returns: -1.
  int reject(const std::string& name, const std::string& reason);
  /// The index given to a name before, or -2 if it was never asked for.
  int known(const std::string& name) const;

 private:
  std::filesystem::path find(const std::string& name) const;

  Model& model_;
  std::filesystem::path folder_;
  std::map<std::string, int> index_by_name_;
  std::map<std::string, int> index_by_path_;
};

}  // namespace farfield
