// SPDX-License-Identifier: Apache-2.0
#include "server/model/file_claims.h"

#include <algorithm>

#include "server/model/file_bytes.h"
#include "server/model/gltf_claims.h"
#include "server/model/ply_claims.h"
#include "server/model/text_lines.h"

namespace farfield {
namespace {

constexpr std::size_t kHeaderBytes = 64 << 10;  // headers of all three formats are far shorter

tl::unexpected<Error> too_much(const std::filesystem::path& path, double claimed, const char* what, double at_least,
                               double size) {
  return fail(ErrorCode::kBadData,
              "{}: the header claims {:.0f} {}, which need at least {:.0f} bytes, but the file has {:.0f}; it is "
              "truncated or damaged: copy it again",
              path.string(), claimed, what, at_least, size);
}

Status check_stl(const std::filesystem::path& path, ByteView bytes, double size) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  // Text files start with "solid", but so do some binary ones; only those without a facet can be binary.
  if (text.starts_with("solid") && (text.find("facet") != text.npos || text.find("endsolid") != text.npos)) return {};
  if (size < 84) return fail(ErrorCode::kBadData, "{}: too short for an STL file; copy it again", path.string());
  ByteReader reader(bytes.subspan(80));
  const double triangles = reader.get<std::uint32_t>();
  if (84 + 50 * triangles > size) return too_much(path, triangles, "triangles", 84 + 50 * triangles, size);
  return {};
}

Status check_off(const std::filesystem::path& path, std::string_view text, double size) {
  std::string_view line;
  double counts[2] = {};
  int found = 0;
  while (found < 2 && next_line(text, line)) {
    line = line.substr(0, line.find('#'));
    for (std::string_view word = next_word(line); !word.empty() && found < 2; word = next_word(line)) {
      if (word.find("OFF") != word.npos || word == "BINARY") continue;  // OFF, COFF, NOFF, STOFF …
      const std::optional<double> number = parse_number<double>(word);
      if (!number)
        return fail(ErrorCode::kBadData, "{}: not an OFF file ('{}' where a count should be); check what it really is",
                    path.string(), std::string(word.substr(0, 20)));
      counts[found++] = *number;
    }
  }
  // "0 0 0\n" is the shortest vertex, "3 0 0 0\n" the shortest triangle.
  const double needed = 6 * counts[0] + 8 * counts[1];
  if (found == 2 && (!(counts[0] >= 0) || !(counts[1] >= 0))) {
    return fail(ErrorCode::kBadData, "{}: the header gives a negative count; copy the file again", path.string());
  }
  if (needed > size + 64) return too_much(path, counts[0] + counts[1], "vertices and faces", needed, size);
  return {};
}

}  // namespace

Result<FileClaims> check_file_claims(const std::filesystem::path& path, ModelFormat format) {
  if (format == ModelFormat::kGlb || format == ModelFormat::kGltf) return check_gltf_claims(path, format);
  const Result<Bytes> start = format == ModelFormat::kIfc ? read_file_bytes(path) : read_file_start(path, kHeaderBytes);
  if (!start) return tl::unexpected(start.error());
  std::error_code error;
  const auto size = static_cast<double>(std::filesystem::file_size(path, error));
  if (error) return fail(ErrorCode::kIo, "{}: {}", path.string(), error.message());
  const std::string_view text(reinterpret_cast<const char*>(start->data()), start->size());
  Status status;
  if (format == ModelFormat::kPly) status = check_ply_claims(path, text, size);
  if (format == ModelFormat::kStl) status = check_stl(path, *start, size);
  if (format == ModelFormat::kOff) status = check_off(path, text, size);
  if (format == ModelFormat::kIfc && text.find("END-ISO-10303-21") == text.npos) {
    status = fail(ErrorCode::kBadData, "{}: the file ends before its end mark END-ISO-10303-21; copy it again",
                  path.string());
  }
  if (!status) return tl::unexpected(status.error());
  return FileClaims{};
}

}  // namespace farfield
