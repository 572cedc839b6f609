#include "bench/exchange/files/nrrd.h"

#include <algorithm>
#include <sstream>

#include "base/file.h"
#include "base/number_text.h"
#include "base/user_error.h"

namespace wobblebench::bench {

namespace {

constexpr std::size_t kMostNrrdHeader = 1 << 20;

std::string vector_text(const glm::dvec3& v) {
  std::ostringstream text;
  text.precision(17);
  text << '(' << v.x << ',' << v.y << ',' << v.z << ')';
  return text.str();
}

std::string joined(const std::vector<std::string>& words, const char* quote) {
  std::string text;
  for (const auto& word : words) text.append(" ").append(quote).append(word).append(quote);
  return text;
}

const std::map<std::string, Element>& nrrd_types() {
  static const std::map<std::string, Element> types = {
      {"signed char", Element::int8},    {"int8", Element::int8},
      {"int8_t", Element::int8},         {"uchar", Element::uint8},
      {"unsigned char", Element::uint8}, {"uint8", Element::uint8},
      {"uint8_t", Element::uint8},       {"short", Element::int16},
      {"int16", Element::int16},         {"int16_t", Element::int16},
      {"ushort", Element::uint16},       {"unsigned short", Element::uint16},
      {"uint16", Element::uint16},       {"uint16_t", Element::uint16},
      {"int", Element::int32},           {"int32", Element::int32},
      {"int32_t", Element::int32},       {"uint", Element::uint32},
      {"unsigned int", Element::uint32}, {"uint32", Element::uint32},
      {"uint32_t", Element::uint32},     {"float", Element::float32},
      {"double", Element::float64}};
  return types;
}

/// Fields and key/value pairs of a header, and where it ends.
struct NrrdText {
  std::map<std::string, std::string> fields;
  std::map<std::string, std::string> pairs;
  std::uint64_t end = 0;
};

NrrdText split_header(const std::filesystem::path& path) {
  const std::string text = read_file(path, kMostNrrdHeader);
  if (!text.starts_with("NRRD000")) throw UserError(path.string() + ": is no NRRD file");
  NrrdText header;
  std::size_t at = text.find('\n');
  while (at != std::string::npos) {
    const std::size_t end = text.find('\n', at + 1);
    if (end == std::string::npos) break;
    const std::string line = trimmed(std::string_view(text).substr(at + 1, end - at - 1));
    at = end;
    if (line.empty()) {
      header.end = end + 1;
      return header;
    }
    if (line.starts_with('#')) continue;
    const std::size_t pair = line.find(":="), colon = line.find(": ");
    if (pair != std::string::npos && pair < colon) {
      header.pairs[line.substr(0, pair)] = line.substr(pair + 2);
    } else if (colon != std::string::npos) {
      header.fields[line.substr(0, colon)] = trimmed(line.substr(colon + 2));
    } else {
      throw UserError(path.string() + ": header line \"" + line + "\" is no FIELD: VALUE");
    }
  }
  throw UserError(path.string() + ": its header has no end; must be an empty line");
}

const std::string& needed(const NrrdText& header,
                          const std::string& field,
                          const std::filesystem::path& path) {
  const auto found = header.fields.find(field);
  if (found == header.fields.end()) throw UserError(path.string() + ": has no field " + field);
  return found->second;
}

std::string value_or(const NrrdText& header, const std::string& field, const std::string& other) {
  const auto found = header.fields.find(field);
  return found == header.fields.end() ? other : found->second;
}

void refuse_other(const NrrdText& header,
                  const std::string& field,
                  const std::vector<std::string>& allowed,
                  const std::filesystem::path& path) {
  const std::string value = value_or(header, field, allowed.front());
  if (std::ranges::find(allowed, value) != allowed.end()) return;
  throw UserError(path.string() + ": " + field + " = " + value + ": must be" + joined(allowed, ""));
}

/// "(1,0,0)" or "none".
std::optional<glm::dvec3> vector_in(const std::filesystem::path& path,
                                    const std::string& field,
                                    std::string text) {
  if (text == "none") return {};
  std::ranges::replace_if(
      text, [](char c) { return c == '(' || c == ')' || c == ','; }, ' ');
  const auto numbers = numbers_in(path, field, text, 3);
  return glm::dvec3(numbers[0], numbers[1], numbers[2]);
}

/// From the file's space to left-posterior-superior.
glm::dvec3 to_lps(const std::string& space, const std::filesystem::path& path) {
  if (space == "left-posterior-superior" || space == "LPS") return glm::dvec3(1);
  if (space == "right-anterior-superior" || space == "RAS") return {-1, -1, 1};
  if (space == "left-anterior-superior" || space == "LAS") return {1, -1, 1};
  throw UserError(path.string() + ": space = " + space +
                  ": must be left-posterior-superior, right-anterior-superior or "
                  "left-anterior-superior");
}

/// "space units: "mm" "mm" "mm"": other units are refused, none are mm.
void check_units(const NrrdText& header, const std::filesystem::path& path) {
  for (const char* field : {"space units", "units"}) {
    std::istringstream words(value_or(header, field, ""));
    for (std::string word; words >> word;) {
      const bool is_time = word == "\"s\"" || word == "\"ms\"" || word == "\"\"" || word == "none";
      if (word == "\"mm\"" || is_time) continue;
      throw UserError(path.string() + ": " + field + " = " + word + ": must be \"mm\"");
    }
  }
}

/// The words of a field of vectors, which may have spaces within their brackets.
std::vector<std::string> vector_words(const std::string& text) {
  std::vector<std::string> words;
  bool inside = false;
  for (const char c : text) {
    if ((c == ' ' || c == '\t') && !inside) {
      words.emplace_back();
      continue;
    }
    if (words.empty()) words.emplace_back();
    inside = c == '(' || (inside && c != ')');
    words.back() += c;
  }
  std::erase(words, "");
  return words;
}

/// `count`: of what the field holds, `what`.
void check_count(const VoxelFile& file,
                 const std::string& field,
                 const std::string& value,
                 std::size_t count,
                 const std::string& what) {
  if (count == file.sizes.size()) return;
  throw UserError(file.path.string() + ": " + field + " = " + value + ": must be " +
                  std::to_string(file.sizes.size()) + " " + what + ", one an axis");
}

void read_directions(VoxelFile& file, const NrrdText& header) {
  const auto found = header.fields.find("space directions");
  if (found == header.fields.end()) {
    const std::string spacings = value_or(header, "spacings", "");
    if (spacings.empty()) return;
    const auto words = vector_words(spacings);
    check_count(file, "spacings", spacings, words.size(), "numbers");
    for (std::size_t axis = 0; axis < words.size(); ++axis) {
      const std::string& word = words[axis];
      auto& direction = file.directions_mm.emplace_back();
      if (word == "nan" || word == "NaN" || axis > 2) continue;
      const double spacing_mm = numbers_in(file.path, "spacings", word, 1)[0];
      direction = glm::dvec3(0);
      (*direction)[static_cast<int>(axis)] = spacing_mm;
    }
    return;
  }
  const glm::dvec3 lps = to_lps(needed(header, "space", file.path), file.path);
  const auto words = vector_words(found->second);
  check_count(file, "space directions", found->second, words.size(), "vectors");
  for (const auto& word : words) {
    auto direction = vector_in(file.path, "space directions", word);
    if (direction) *direction *= lps;
    file.directions_mm.push_back(direction);
  }
  file.origin_mm =
      lps * vector_in(file.path, "space origin", value_or(header, "space origin", "(0,0,0)"))
                .value_or(glm::dvec3(0));
}

}  // namespace

std::string nrrd_text(const NrrdHeader& header) {
  std::ostringstream text;
  const bool placed = !header.directions_mm.empty();
  text << "NRRD0005\n# http://teem.sourceforge.net/nrrd/format.html\ntype: "
       << (header.element == Element::float32 ? "float" : std::string(element_name(header.element)))
       << "\ndimension: " << header.sizes.size() << "\n";
  if (placed) text << "space: left-posterior-superior\n";
  text << "sizes:";
  for (const auto size : header.sizes) text << " " << size;
  if (placed) text << "\nspace directions:";
  for (const auto& direction : header.directions_mm) {
    text << " " << (direction ? vector_text(*direction) : "none");
  }
  text << "\nkinds:" << joined(header.kinds, "");
  if (!header.labels.empty()) text << "\nlabels:" << joined(header.labels, "\"");
  if (element_bytes(header.element) > 1) text << "\nendian: little";
  text << "\nencoding: raw\n";
  if (placed) {
    text << "space units: \"mm\" \"mm\" \"mm\"\nspace origin: " << vector_text(header.origin_mm)
         << "\n";
  }
  for (const auto& [key, value] : header.fields) text << key << ":=" << value << "\n";
  text << "\n";
  return text.str();
}

VoxelFile read_nrrd(const std::filesystem::path& path) {
  const NrrdText header = split_header(path);
  VoxelFile file{.path = path, .data_path = path, .offset = header.end};
  for (const char* field : {"data file", "datafile", "line skip", "byte skip"}) {
    if (!header.fields.contains(field)) continue;
    throw UserError(path.string() + ": " + field + " = " + header.fields.at(field) +
                    ": must not be given: voxels follow the header in one file");
  }
  refuse_other(header, "encoding", {"raw"}, path);
  const std::string& type = needed(header, "type", path);
  if (!nrrd_types().contains(type)) {
    throw UserError(path.string() + ": type = " + type + ": must be an integer of 8, 16 or 32 " +
                    "bits, float or double");
  }
  file.element = nrrd_types().at(type);
  if (element_bytes(file.element) > 1) {
    needed(header, "endian", path);
    refuse_other(header, "endian", {"little", "big"}, path);
    file.big_endian = header.fields.at("endian") == "big";
  }
  file.sizes = sizes_in(path, "sizes", needed(header, "sizes", path));
  const auto dimension = numbers_in(path, "dimension", needed(header, "dimension", path), 1)[0];
  if (dimension != static_cast<double>(file.sizes.size())) {
    throw UserError(path.string() + ": dimension = " + header.fields.at("dimension") + ": has " +
                    std::to_string(file.sizes.size()) + " sizes");
  }
  check_units(header, path);
  read_directions(file, header);
  file.fields = header.pairs;
  check_size(file);
  return file;
}

}  // namespace wobblebench::bench
