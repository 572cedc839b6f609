#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <assimp/Importer.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
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
#include "phantoms/io/triangle_mesh.h"

namespace wobblebench::phantoms {
namespace {

enum class Number { i8, u8, i16, u16, i32, u32, f32, f64 };

struct Property {
  Number value = Number::f32;
  bool is_list = false;
  Number count = Number::u8;  // type of a list's length
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

void check_list(Body& body, const Property& list, bool is_face, double vertices) {
  const double count = body.next(list.count);
  if (!(count >= (is_face ? 3 : 0))) throw damaged("a face of less than three corners");
  for (long i = 0; static_cast<double>(i) < count; ++i) {
    const double value = body.next(list.value);
    if (is_face && !(value >= 0 && value < vertices)) {
      throw damaged("a corner that is no vertex");
    }
  }
}

// Parses a PLY file as its header describes it: Assimp 5.2 reads past the end of a truncated one.
// Throws std::invalid_argument with one line for a truncated header or body, an element of more
// than 100 properties, a word that is no number, a face of fewer than three corners, or a vertex
// index out of range.
void check_ply(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  const Header header = read_header(in);
  Body body(in, header.format);
  double vertices = 0;
  for (const Element& element : header.elements) {
    if (element.name == "vertex") vertices = double(element.count);
    if (element.properties.empty()) throw damaged("an element without properties");
    for (std::uint64_t i = 0; i < element.count; ++i) {
      for (const Property& property : element.properties) {
        if (property.is_list) {
          check_list(body, property, element.name == "face", vertices);
        } else {
          body.next(property.value);
        }
      }
    }
  }
}

// Checks for faces on which Assimp's triangulation would abort.
void check_faces(const aiScene& scene) {
  for (unsigned i = 0; i < scene.mNumMeshes; ++i) {
    const aiMesh& mesh = *scene.mMeshes[i];
    for (unsigned face = 0; face < mesh.mNumFaces; ++face) {
      for (unsigned corner = 0; corner < mesh.mFaces[face].mNumIndices; ++corner) {
        if (mesh.mFaces[face].mIndices[corner] < mesh.mNumVertices) continue;
        throw std::invalid_argument("has a face without its vertices");
      }
      if (mesh.mFaces[face].mNumIndices > 0) continue;
      throw std::invalid_argument("has a face without corners");
    }
  }
}

// Assimp's message, as one line of UTF-8.
std::string reason_of(const Assimp::Importer& importer) {
  std::string text = importer.GetErrorString();
  std::replace_if(text.begin(), text.end(), is_control, ' ');
  return is_utf8(text) ? text : "damaged";
}

void write_vertices(const aiScene& scene, MessageWriter& out) {
  std::uint64_t count = 0;
  for (unsigned i = 0; i < scene.mNumMeshes; ++i) count += scene.mMeshes[i]->mNumVertices;
  out.put(count);
  for (unsigned i = 0; i < scene.mNumMeshes; ++i) {
    const aiMesh& mesh = *scene.mMeshes[i];
    for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
      const aiVector3D& at = mesh.mVertices[v];
      for (const float axis : {at.x, at.y, at.z}) out.put(double(axis));
    }
  }
}

void write_triangles(const aiScene& scene, MessageWriter& out) {
  std::vector<TriangleMesh::Triangle> triangles;
  std::uint32_t first = 0;
  for (unsigned i = 0; i < scene.mNumMeshes; ++i) {
    const aiMesh& mesh = *scene.mMeshes[i];
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      if (face.mNumIndices != 3) continue;
      triangles.push_back(
          {first + face.mIndices[0], first + face.mIndices[1], first + face.mIndices[2]});
    }
    first += mesh.mNumVertices;
  }
  out.list(std::span<const TriangleMesh::Triangle>(triangles));
}

}  // namespace

void write_mesh_message(const std::filesystem::path& path, MessageWriter& out) {
  if (lower_case_extension(path) == ".ply") check_ply(path);
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(path.string(), 0);
  if (scene != nullptr) {
    check_faces(*scene);
    scene = importer.ApplyPostProcessing(aiProcess_Triangulate);
  }
  if (scene == nullptr) {
    throw std::invalid_argument("not a readable mesh (" + reason_of(importer) + ")");
  }
  write_vertices(*scene, out);
  write_triangles(*scene, out);
}

}  // namespace wobblebench::phantoms
