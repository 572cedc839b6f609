#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <glm/geometric.hpp>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "base/file.h"
#include "phantoms/import/parsers.h"
#include "phantoms/import/polygon.h"

namespace wobblebench::phantoms {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::size_t kHeaderBytes = 84, kFacetBytes = 50;

std::invalid_argument unreadable(const std::string& what) {
  return std::invalid_argument("not a readable mesh (STL: " + what + ")");
}

std::string lower_case(std::string text) {
  std::ranges::transform(text, text.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  return text;
}

/// Binary headers may begin with "solid", too; texts hold no zeros.
bool is_text(const std::string& bytes) {
  const std::string begin = bytes.substr(0, 512);
  const auto word = begin.find_first_not_of(" \t\r\n");
  return begin.find('\0') == std::string::npos && word != std::string::npos &&
         lower_case(begin.substr(word, 5)) == "solid";
}

/// Words of an STL in text, a triangle a loop.
class TextReader {
 public:
  explicit TextReader(const std::string& bytes) : in_(bytes) {}

  TriangleMesh read() {
    for (std::string word; in_ >> word;) read_statement(lower_case(word));
    if (in_solid_ || !loop_.empty()) throw unreadable("it ends too early");
    return std::move(mesh_);
  }

 private:
  void read_statement(const std::string& word) {
    if (word == "solid" || word == "endsolid") {
      std::string name;
      std::getline(in_, name);
      in_solid_ = word == "solid";
    } else if (word == "facet") {
      std::string normal;
      in_ >> normal;
      (void)read_vector();
    } else if (word == "vertex") {
      loop_.push_back(static_cast<std::uint32_t>(mesh_.vertices.size()));
      mesh_.vertices.push_back(read_vector());
    } else if (word == "endloop") {
      if (loop_.size() < 3) throw unreadable("a facet of less than three corners");
      add_face(mesh_, loop_);
      loop_.clear();
    } else if (word != "outer" && word != "loop" && word != "endfacet") {
      throw unreadable("a word that is none of its format's");
    }
  }

  glm::dvec3 read_vector() {
    glm::dvec3 vector(0);
    for (int axis = 0; axis < 3; ++axis) {
      std::string word;
      if (!(in_ >> word)) throw unreadable("it ends too early");
      char* end = nullptr;
      vector[axis] = std::strtod(word.c_str(), &end);
      if (end != word.c_str() + word.size()) throw unreadable("a word that is no number");
    }
    return vector;
  }

  std::istringstream in_;
  TriangleMesh mesh_;
  std::vector<std::uint32_t> loop_;
  bool in_solid_ = false;
};

struct Facet {
  glm::dvec3 normal;
  std::array<glm::dvec3, 3> corners;
};

Facet facet_at(const std::string& bytes, std::size_t index) {
  std::array<float, 12> values{};
  std::memcpy(values.data(), bytes.data() + kHeaderBytes + index * kFacetBytes, sizeof values);
  const auto vector = [&](std::size_t i) {
    return glm::dvec3(values[3 * i], values[3 * i + 1], values[3 * i + 2]);
  };
  return {vector(0), {vector(1), vector(2), vector(3)}};
}

/// Whether these bytes are a triangle: its normal is a unit vector or left out.
bool is_facet(const std::string& bytes, std::size_t index) {
  const Facet facet = facet_at(bytes, index);
  const double length = glm::length(facet.normal);
  double sum = 0;
  for (const glm::dvec3& corner : facet.corners) sum += glm::length(corner);
  return std::isfinite(sum) && (length == 0 || std::abs(length - 1) < 1e-2);
}

/// How many triangles a binary file holds. Bytes behind them are left out while they are fewer than
/// a triangle's. A count that contradicts the length is taken for wrong where all that is there is
/// triangles: programs that cannot go back write 0 or the largest number.
std::size_t facets_in(const std::string& bytes) {
  if (bytes.size() < kHeaderBytes) throw unreadable("it ends too early");
  std::uint32_t counted = 0;
  std::memcpy(&counted, bytes.data() + kHeaderBytes - sizeof counted, sizeof counted);
  const std::size_t held = (bytes.size() - kHeaderBytes) / kFacetBytes;
  const std::size_t rest = (bytes.size() - kHeaderBytes) % kFacetBytes;
  if (counted == held && held > 0) return held;
  const bool is_unset = counted == 0 || counted == 0xffffffff;
  std::size_t index = is_unset ? 0 : counted;
  while (rest == 0 && index < held && is_facet(bytes, index)) ++index;
  if (rest == 0 && index == held && held > 0) return held;
  throw unreadable("its header counts " + std::to_string(counted) +
                   " triangles, and its length is that of " + std::to_string(held) + " and " +
                   std::to_string(rest) + " bytes: it is cut off or damaged, or other data follow");
}

TriangleMesh read_binary(const std::string& bytes) {
  TriangleMesh mesh;
  for (std::size_t i = 0, count = facets_in(bytes); i < count; ++i) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const glm::dvec3& corner : facet_at(bytes, i).corners) mesh.vertices.push_back(corner);
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

}  // namespace

TriangleMesh read_stl(const std::filesystem::path& path) {
  const std::string bytes = read_file(path);
  return is_text(bytes) ? TextReader(bytes).read() : read_binary(bytes);
}

}  // namespace wobblebench::phantoms
