#include "bench/exchange/files/nrrd.h"

#include <algorithm>
#include <sstream>

#include "base/file.h"
#include "base/number_text.h"
#include "base/text.h"
#include "base/user_error.h"
#include "bench/exchange/files/stored_voxels.h"

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

const ElementNames kNrrdTypes = {
    {Element::int8, "|signed char|int8|int8_t|"},
    {Element::uint8, "|uchar|unsigned char|uint8|uint8_t|"},
    {Element::int16, "|short|short int|signed short|signed short int|int16|int16_t|"},
    {Element::uint16, "|ushort|unsigned short|unsigned short int|uint16|uint16_t|"},
    {Element::int32, "|int|signed int|int32|int32_t|"},
    {Element::uint32, "|uint|unsigned int|uint32|uint32_t|"},
    {Element::float32, "|float|"},
    {Element::float64, "|double|"}};

/// Fields and key/value pairs of a header, and where it ends.
struct NrrdText {
  HeaderFields fields, pairs;
  std::uint64_t end = SIZE_MAX;
};

constexpr std::initializer_list<const char*> kDataFile = {"data file", "datafile"};

NrrdText split_header(const std::filesystem::path& path) {
  const std::string text = read_file(path, kMostNrrdHeader);
  if (!text.starts_with("NRRD000")) throw UserError(path.string() + ": is no NRRD file");
  NrrdText header;
  for (std::size_t at = text.find('\n'); at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at + 1), text.size());
    const std::string line = trimmed(std::string_view(text).substr(at + 1, end - at - 1)) + " ";
    at = end;
    // A header that lies apart may end with its file.
    if (end == text.size() && field_of(header.fields, kDataFile) == nullptr) break;
    if (line == " ") {
      header.end = end + 1;
      break;
    }
    if (line.starts_with('#')) continue;
    const std::size_t pair = line.find(":="), colon = line.find(": ");
    if (std::min(pair, colon) == std::string::npos) {
      throw UserError(path.string() + ": header line \"" + trimmed(line) + "\" is no FIELD: VALUE");
    }
    auto& into = pair < colon ? header.pairs : header.fields;
    into[line.substr(0, std::min(pair, colon))] = trimmed(line.substr(std::min(pair, colon) + 2));
  }
  if (header.end <= text.size() || field_of(header.fields, kDataFile) != nullptr) return header;
  throw UserError(path.string() + ": its header has no end; must be an empty line");
}

const std::string& needed(const NrrdText& header,
                          const char* field,
                          const std::filesystem::path& path) {
  if (const auto* found = field_of(header.fields, {field})) return found->second;
  throw UserError(path.string() + ": has no field " + field);
}

std::string value_or(const NrrdText& header,
                     std::initializer_list<const char*> names,
                     const std::string& other) {
  const auto* found = field_of(header.fields, names);
  return found == nullptr ? other : found->second;
}

/// "(1,0,0)" or "none"; of `count` numbers, which are three and perhaps that of time.
std::optional<glm::dvec3> vector_in(const std::filesystem::path& path,
                                    const std::string& field,
                                    std::string text,
                                    std::size_t count) {
  if (lower_case(text) == "none") return {};
  std::ranges::replace_if(
      text, [](char c) { return c == '(' || c == ')' || c == ','; }, ' ');
  const auto numbers = numbers_in(path, field, text, count);
  return glm::dvec3(numbers[0], numbers[1], numbers[2]);
}

/// From the file's space to left-posterior-superior; none: another space.
std::optional<glm::dvec3> to_lps(const std::string& space) {
  if (space == "left-posterior-superior" || space == "lps") return glm::dvec3(1);
  if (space == "right-anterior-superior" || space == "ras") return glm::dvec3(-1, -1, 1);
  if (space == "left-anterior-superior" || space == "las") return glm::dvec3(1, -1, 1);
  return {};
}

/// "space units: "mm" "mm" "mm"": other units are refused, none are mm.
void check_units(const NrrdText& header, const std::filesystem::path& path) {
  for (const char* field : {"space units", "units"}) {
    std::istringstream words(lower_case(value_or(header, {field}, "")));
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

void read_spacings(VoxelFile& file, const std::string& spacings) {
  const auto words = vector_words(spacings);
  check_count(file, "spacings", spacings, words.size(), "numbers");
  for (std::size_t axis = 0; axis < words.size(); ++axis) {
    auto& direction = file.directions_mm.emplace_back();
    if (lower_case(words[axis]) == "nan" || axis > 2) continue;
    const double spacing_mm = numbers_in(file.path, "spacings", words[axis], 1)[0];
    direction = glm::dvec3(0);
    (*direction)[static_cast<int>(axis)] = spacing_mm;
  }
}

/// Sticks need none: what is missing is said where it is needed.
void read_directions(VoxelFile& file, const NrrdText& header) {
  const std::string given = value_or(header, {"space directions"}, "");
  const std::string spacings = value_or(header, {"spacings"}, "");
  if (given.empty() && !spacings.empty()) return read_spacings(file, spacings);
  file.missing = given.empty() ? "space directions are missing" : "space is missing";
  std::string space = lower_case(value_or(header, {"space"}, ""));
  if (given.empty() || space.empty()) return;
  const std::size_t whole = space.size();
  if (space.ends_with("-time")) space.resize(whole - 5);
  if (space.size() == 4 && space.ends_with('t')) space.resize(3);
  const std::size_t axes = space.size() < whole ? 4 : 3;
  const auto lps = to_lps(space);
  if (!lps) {
    throw UserError(file.path.string() + ": space = " + needed(header, "space", file.path) +
                    ": must be left-posterior-superior, right-anterior-superior or "
                    "left-anterior-superior");
  }
  const auto words = vector_words(given);
  check_count(file, "space directions", given, words.size(), "vectors");
  for (const auto& word : words) {
    auto direction = vector_in(file.path, "space directions", word, axes);
    if (direction) *direction *= *lps;
    file.directions_mm.push_back(direction);
  }
  const std::string origin = value_or(header, {"space origin"}, "none");
  file.origin_mm =
      *lps * vector_in(file.path, "space origin", origin, axes).value_or(glm::dvec3(0));
}

StoredVoxels stored_voxels(const NrrdText& header, const std::filesystem::path& path) {
  StoredVoxels stored{.field = "data file", .file = value_or(header, kDataFile, "")};
  const std::string encoding = lower_case(value_or(header, {"encoding"}, "raw"));
  using As = StoredVoxels::As;
  static const std::map<std::string, As> known = {{"raw", As::raw},
                                                  {"gzip", As::deflated},
                                                  {"gz", As::deflated},
                                                  {"ascii", As::text},
                                                  {"text", As::text},
                                                  {"txt", As::text}};
  if (!known.contains(encoding)) {
    throw UserError(path.string() + ": encoding = " + encoding + ": must be raw, gzip or ascii");
  }
  stored.as = known.at(encoding);
  stored.skipped_lines =
      whole_in(path, "line skip", value_or(header, {"line skip", "lineskip"}, "0"), 0);
  stored.skipped_bytes =
      whole_in(path, "byte skip", value_or(header, {"byte skip", "byteskip"}, "0"), -1);
  return stored;
}

void read_byte_order(VoxelFile& file, const NrrdText& header) {
  if (element_bytes(file.element) == 1) return;
  const std::string order = lower_case(needed(header, "endian", file.path));
  file.big_endian = order == "big";
  if (file.big_endian || order == "little") return;
  throw UserError(file.path.string() + ": endian = " + order + ": must be little or big");
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
  const std::string& type = needed(header, "type", path);
  const auto element = element_of(kNrrdTypes, type);
  if (!element) {
    throw UserError(path.string() + ": type = " + type + ": must be an integer of 8, 16 or 32 " +
                    "bits, float or double");
  }
  file.element = *element;
  const StoredVoxels stored = stored_voxels(header, path);
  if (stored.as != StoredVoxels::As::text) read_byte_order(file, header);
  file.sizes = sizes_in(path, "sizes", needed(header, "sizes", path));
  const std::string& dimension = needed(header, "dimension", path);
  if (numbers_in(path, "dimension", dimension, 1)[0] != static_cast<double>(file.sizes.size())) {
    throw UserError(path.string() + ": dimension = " + dimension + ": has " +
                    std::to_string(file.sizes.size()) + " sizes");
  }
  check_units(header, path);
  read_directions(file, header);
  file.fields = header.pairs;
  take_voxels(stored, file);
  return file;
}

}  // namespace wobblebench::bench
