#include <assimp/DefaultIOSystem.h>
#include <assimp/scene.h>
#include <assimp/Importer.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/text.h"
#include "phantoms/import/parsers.h"
#include "phantoms/import/polygon.h"
#include "phantoms/io/triangle_mesh.h"

namespace wobblebench::phantoms {
namespace {

enum class Number { i8, u8, i16, u16, i32, u32, f32, f64 };

struct Property {
  std::string name;
  Number value = Number::f32;
  bool is_list = false;
  Number count = Number::u8;  // type of a list's length

  /// Of faces: the other lists are textures' and the like.
  bool holds_corners() const { return name == "vertex_indices" || name == "vertex_index"; }
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

struct Header {
  std::string format;
  std::vector<Element> elements;
};

/// Files in use have some dozens; hundreds cost tens of seconds before they are refused.
constexpr std::size_t kMostProperties = 100;

std::invalid_argument damaged(const std::string& what) {
  return std::invalid_argument("not a readable mesh (PLY: " + what + ")");
}

Number number_of(const std::string& name) {
  static const std::map<std::string, Number> known = {{"char", Number::i8},
                                                      {"int8", Number::i8},
                                                      {"uchar", Number::u8},
                                                      {"uint8", Number::u8},
                                                      {"short", Number::i16},
                                                      {"int16", Number::i16},
                                                      {"ushort", Number::u16},
                                                      {"uint16", Number::u16},
                                                      {"int", Number::i32},
                                                      {"int32", Number::i32},
                                                      {"uint", Number::u32},
                                                      {"uint32", Number::u32},
                                                      {"float", Number::f32},
                                                      {"float32", Number::f32},
                                                      {"double", Number::f64},
                                                      {"float64", Number::f64}};
  const auto found = known.find(name);
  if (found == known.end()) throw damaged("a property of no known type");
  return found->second;
}

Property read_property(std::istream& words) {
  Property property;
  std::string type;
  words >> type;
  if (type == "list") {
    std::string count;
    words >> count >> type;
    property.is_list = true;
    property.count = number_of(count);
  }
  property.value = number_of(type);
  words >> property.name;
  return property;
}

// A line of the header, without its end of line (LF or CR LF).
std::string next_line(std::istream& in) {
  std::string line;
  if (!std::getline(in, line)) throw damaged("its header ends too early");
  if (!line.empty() && line.back() == '\r') line.pop_back();
  return line;
}

Header read_header(std::istream& in) {
  if (next_line(in) != "ply") throw damaged("it does not begin with \"ply\"");
  Header header;
  for (;;) {
    std::istringstream words(next_line(in));
    std::string word;
    words >> word;
    if (word == "end_header") return header;
    if (word == "format") words >> header.format;
    if (word == "element") {
      Element element;
      if (!(words >> element.name >> element.count)) throw damaged("an element without a count");
      header.elements.push_back(element);
    }
    if (word == "property") {
      if (header.elements.empty()) throw damaged("a property of no element");
      auto& properties = header.elements.back().properties;
      if (properties.size() == kMostProperties) {
        throw damaged("an element of more than " + std::to_string(kMostProperties) + " properties");
      }
      properties.push_back(read_property(words));
    }
  }
}

// Reads the numbers of the body one after the other.
class Body {
 public:
  Body(std::istream& in, const std::string& format) : in_(in), format_(format) {
    if (format != "ascii" && format != "binary_little_endian" && format != "binary_big_endian") {
      throw damaged("of no known format");
    }
  }

  double next(Number type) {
    if (format_ == "ascii") return next_word();
    switch (type) {
      case Number::i8:
        return next_bytes<std::int8_t>();
      case Number::u8:
        return next_bytes<std::uint8_t>();
      case Number::i16:
        return next_bytes<std::int16_t>();
      case Number::u16:
        return next_bytes<std::uint16_t>();
      case Number::i32:
        return next_bytes<std::int32_t>();
      case Number::u32:
        return next_bytes<std::uint32_t>();
      case Number::f32:
        return double(next_bytes<float>());
      case Number::f64:
        return next_bytes<double>();
    }
    throw std::logic_error("Number: no such type");
  }

 private:
  double next_word() {
    std::string word;
    if (!(in_ >> word)) throw damaged("it ends too early");
    if (word.find(".#") != std::string::npos) return NAN;  // 1.#IND, -1.#INF: of old Windows
    char* end = nullptr;
    const double value = std::strtod(word.c_str(), &end);
    if (end != word.c_str() + word.size()) throw damaged("a word that is no number");
    return value;
  }

  template <class T>
  T next_bytes() {
    std::array<char, sizeof(T)> bytes;
    if (!in_.read(bytes.data(), bytes.size())) throw damaged("it ends too early");
    const bool is_big = format_ == "binary_big_endian";
    if (is_big != (std::endian::native == std::endian::big)) {
      std::reverse(bytes.begin(), bytes.end());
    }
    return std::bit_cast<T>(bytes);
  }

  std::istream& in_;
  std::string format_;
};

void check_list(Body& body, const Property& list, bool corners, double vertices) {
  const double count = body.next(list.count);
  if (!(count >= 0)) throw damaged("a list of negative length");
  if (corners && count < 3) throw damaged("a face of less than three corners");
  for (long i = 0; static_cast<double>(i) < count; ++i) {
    const double value = body.next(list.value);
    if (corners && !(value >= 0 && value < vertices)) throw damaged("a corner that is no vertex");
  }
}

// Parses a PLY file as its header describes it: Assimp 5.2 reads past the end of a truncated one.
// Throws std::invalid_argument with one line for a truncated header or body, an element of more
// than 100 properties, a word that is no number, a face of fewer than three corners, or a vertex
// index out of range. Returns the vertices of a file without faces, with those that are not finite:
// Assimp stumbles over some.
std::vector<glm::dvec3> check_ply(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  const Header header = read_header(in);
  Body body(in, header.format);
  double vertices = 0;
  bool has_faces = false;
  std::vector<glm::dvec3> points;
  for (const Element& element : header.elements) {
    if (element.name == "vertex") vertices = double(element.count);
    has_faces = has_faces || (element.name == "face" && element.count > 0);
    if (element.properties.empty()) throw damaged("an element without properties");
    for (std::uint64_t i = 0; i < element.count; ++i) {
      if (element.name == "vertex") points.emplace_back(0);
      for (const Property& property : element.properties) {
        if (property.is_list) {
          const bool corners = element.name == "face" && property.holds_corners();
          check_list(body, property, corners, vertices);
        } else {
          const double value = body.next(property.value);
          const std::size_t axis = std::string_view("xyz").find(property.name);
          if (element.name == "vertex" && property.name.size() == 1 && axis < 3) {
            points.back()[static_cast<int>(axis)] = value;
          }
        }
      }
    }
  }
  if (has_faces) points.clear();
  return points;
}

// Assimp's message, as one line of UTF-8.
std::string reason_of(const Assimp::Importer& importer) {
  std::string text = importer.GetErrorString();
  std::replace_if(text.begin(), text.end(), is_control, ' ');
  return is_utf8(text) ? text : "damaged";
}

// Adds a mesh of the scene. Points and lines are left out.
void add(const aiMesh& part, TriangleMesh& mesh) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (unsigned v = 0; v < part.mNumVertices; ++v) {
    const aiVector3D& at = part.mVertices[v];
    mesh.vertices.emplace_back(at.x, at.y, at.z);
  }
  std::vector<std::uint32_t> corners;
  for (unsigned f = 0; f < part.mNumFaces; ++f) {
    const aiFace& face = part.mFaces[f];
    corners.clear();
    for (unsigned i = 0; i < face.mNumIndices; ++i) {
      if (face.mIndices[i] >= part.mNumVertices) {
        throw std::invalid_argument("has a face without its vertices");
      }
      corners.push_back(first + face.mIndices[i]);
    }
    if (corners.size() >= 3) add_face(mesh, corners);
  }
}

// Opens what a mesh names, its material library say: a FIFO would be waited for.
class RegularFiles : public Assimp::DefaultIOSystem {
 public:
  bool Exists(const char* file) const override {  // Assimp's own opens it
    std::error_code error;
    return std::filesystem::is_regular_file(file, error);
  }
  Assimp::IOStream* Open(const char* file, const char* mode) override {
    return Exists(file) ? DefaultIOSystem::Open(file, mode) : nullptr;
  }
};

// Reads by Assimp. Its polygons are kept as they are: Assimp 5.2 cuts concave ones with folds.
TriangleMesh read_by_assimp(const std::filesystem::path& path) {
  Assimp::Importer importer;
  importer.SetIOHandler(new RegularFiles);  // owned by it
  const aiScene* scene = importer.ReadFile(path.string(), 0);
  if (scene == nullptr) {
    throw std::invalid_argument("not a readable mesh (" + reason_of(importer) + ")");
  }
  TriangleMesh mesh;
  for (unsigned i = 0; i < scene->mNumMeshes; ++i) add(*scene->mMeshes[i], mesh);
  return mesh;
}

}  // namespace

void write_mesh_message(const std::filesystem::path& path, MessageWriter& out) {
  const std::string extension = lower_case_extension(path);
  TriangleMesh mesh;
  if (extension == ".ply") mesh.vertices = check_ply(path);
  if (mesh.vertices.empty()) mesh = extension == ".stl" ? read_stl(path) : read_by_assimp(path);
  out.list(std::span<const glm::dvec3>(mesh.vertices));
  out.list(std::span<const TriangleMesh::Triangle>(mesh.triangles));
}

}  // namespace wobblebench::phantoms
