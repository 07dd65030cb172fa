// SPDX-License-Identifier: Apache-2.0
#include "server/model/ply_claims.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "server/model/file_bytes.h"
#include "server/model/text_lines.h"

namespace farfield {
namespace {

std::size_t type_bytes(std::string_view type) {
  static constexpr std::pair<std::string_view, int> kTypes[] = {
      {"char", 1},  {"uchar", 1},   {"int8", 1},   {"uint8", 1},  {"short", 2}, {"ushort", 2},
      {"int16", 2}, {"uint16", 2},  {"int", 4},    {"uint", 4},   {"int32", 4}, {"uint32", 4},
      {"float", 4}, {"float32", 4}, {"double", 8}, {"float64", 8}};
  for (const auto& [name, bytes] : kTypes) {
    if (name == type) return static_cast<std::size_t>(bytes);
  }
  return 1;
}

struct Property {
  std::size_t count_bytes = 0;  // of a list's length; 0: no list
  std::size_t bytes = 1;        // of a value
};

struct Element {
  double count = 0;
  std::vector<Property> properties;

  bool has_list() const {
    return std::any_of(properties.begin(), properties.end(), [](const Property& p) { return p.count_bytes > 0; });
  }
};

struct Header {
  bool is_ascii = false, is_big_endian = false;
  std::vector<Element> elements;
  std::size_t bytes = 0;  // to the first of the data; 0: no end was found
};

Header read_header(std::string_view start) {
  Header header;
  std::string_view rest = start, line;
  while (next_line(rest, line)) {
    const std::string_view key = next_word(line);
    if (key == "format") {
      const std::string_view format = next_word(line);
      header.is_ascii = format == "ascii";
      header.is_big_endian = format == "binary_big_endian";
    } else if (key == "element") {
      next_word(line);  // its name
      header.elements.push_back({parse_number<double>(next_word(line)).value_or(0), {}});
    } else if (key == "property" && !header.elements.empty()) {
      const std::string_view type = next_word(line);
      Property property;
      if (type == "list") property.count_bytes = type_bytes(next_word(line));
      property.bytes = type_bytes(type == "list" ? next_word(line) : type);
      header.elements.back().properties.push_back(property);
    } else if (key == "end_header") {
      header.bytes = start.size() - rest.size();
      break;
    }
  }
  return header;
}

/// What follows a header: values are skipped, lists say how many values they have.
class Data {
 public:
  Data(const Header& header, std::string_view bytes) : header_(header), rest_(bytes) {}

  bool is_over() const { return rest_.empty(); }
  /// The values of a list that cannot be in the file; 0 if all can.
  double impossible_list(const Property& property) {
    if (property.count_bytes == 0) {
      skip(1, property.bytes);
      return 0;
    }
    const double count = header_.is_ascii ? parse_number<double>(word()).value_or(0) : binary_count(property.count_bytes);
    const double least = count * (header_.is_ascii ? 2.0 : static_cast<double>(property.bytes));  // a digit, a blank
    if (least > static_cast<double>(rest_.size()) + 1) return count;
    skip(count, property.bytes);
    return 0;
  }
  void skip(double values, std::size_t bytes) {
    if (!header_.is_ascii) {
      const double size = values * static_cast<double>(bytes), most = static_cast<double>(rest_.size());
      rest_.remove_prefix(static_cast<std::size_t>(std::clamp(size, 0.0, most)));
      return;
    }
    for (double i = 0; i < values && !rest_.empty(); ++i) word();
  }

 private:
  std::string_view word() {
    const auto is_gap = [](char c) { return c == '\n' || is_blank(c); };
    const auto begin = std::find_if_not(rest_.begin(), rest_.end(), is_gap);
    const auto end = std::find_if(begin, rest_.end(), is_gap);
    const std::string_view found(begin, end);
    rest_ = std::string_view(end, rest_.end());
    return found;
  }
  double binary_count(std::size_t bytes) {
    std::uint64_t count = 0;
    for (std::size_t i = 0; i < std::min(bytes, rest_.size()); ++i) {
      const std::uint64_t byte = static_cast<std::uint8_t>(rest_[i]);
      count = header_.is_big_endian ? count << 8 | byte : count | byte << (8 * i);
    }
    rest_.remove_prefix(std::min(bytes, rest_.size()));
    return static_cast<double>(count);
  }

  const Header& header_;
  std::string_view rest_;
};

/// Importers take memory for a list before they have seen its values.
Status check_lists(const std::filesystem::path& path, const Header& header, std::string_view bytes) {
  Data data(header, bytes);
  for (const Element& element : header.elements) {
    if (!element.has_list()) {
      for (const Property& property : element.properties) data.skip(element.count, property.bytes);
      continue;
    }
    for (double i = 0; i < element.count && !data.is_over(); ++i) {
      for (const Property& property : element.properties) {
        if (const double count = data.impossible_list(property); count > 0) {
          return fail(ErrorCode::kBadData, "{}: a list claims {:.0f} values, more than the rest of the file holds; it is "
                      "truncated or damaged: copy it again", path.string(), count);
        }
      }
    }
  }
  return {};
}

}  // namespace

Status check_ply_claims(const std::filesystem::path& path, std::string_view start, double size) {
  const Header header = read_header(start);
  double needed = 0, largest_count = 0;
  bool has_list = false;
  for (const Element& element : header.elements) {
    if (!(element.count >= 0))
      return fail(ErrorCode::kBadData, "{}: the header gives a negative count; copy the file again", path.string());
    if (element.count > size && element.properties.empty())
      return fail(ErrorCode::kBadData, "{}: the header claims {:.0f} elements without a property; copy the file again",
                  path.string(), element.count);
    double per_element = 0;
    // As text every value takes a digit and a separator; a list needs at least its count.
    for (const Property& p : element.properties)
      per_element += header.is_ascii ? 2.0 : static_cast<double>(p.count_bytes > 0 ? p.count_bytes : p.bytes);
    needed += element.count * per_element;
    largest_count = std::max(largest_count, element.count);
    has_list = has_list || element.has_list();
  }
  if (needed > size + 1) {
    return fail(ErrorCode::kBadData,
                "{}: the header claims {:.0f} elements, which need at least {:.0f} bytes, but the file has {:.0f}; it is "
                "truncated or damaged: copy it again",
                path.string(), largest_count, needed, size);
  }
  if (!has_list || header.bytes == 0) return {};
  const Result<Bytes> bytes = read_file_bytes(path);
  if (!bytes) return tl::unexpected(bytes.error());
  const std::string_view text(reinterpret_cast<const char*>(bytes->data()), bytes->size());
  return check_lists(path, header, text.substr(std::min(header.bytes, text.size())));
}

}  // namespace farfield
