// Points in millimetres of a depth map that `wobblebench run` wrote, from its header alone, and how
// far they lie from a mesh (docs/units.md, "From a depth map to points").
//
//   g++ -std=c++20 -O2 examples/cpp/depth_to_points.cpp $(pkg-config --cflags --libs OpenImageIO)
//   -o depth_to_points
//   ./depth_to_points out/depth.exr > points.xyz
//   ./depth_to_points out/depth.exr docs/scenes/pebble.obj 0 0 110 > points.xyz
//
// X Y Z is where the middle of the mesh's bounding box lies in front of the probe, mm:
// scene.placement.position_mm of report.json. Points are in the probe frame.
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <glm/glm.hpp>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

struct DepthMap {
  int width = 0, height = 0;
  std::vector<float> z_mm;  // length of each pixel's ray; NaN: no surface
  glm::dmat4 to_camera{1}, to_ndc{1};
  bool parallel = true;
};

// The file has points as rows, [x y z 1] M; read column by column this is the matrix that GLM
// multiplies from the left.
glm::dmat4 matrix(const OIIO::ImageSpec& spec, const std::string& name) {
  float numbers[16];
  if (!spec.getattribute(name, OIIO::TypeMatrix, numbers)) {
    throw std::runtime_error("the file lacks " + name);
  }
  glm::dmat4 m;
  for (int i = 0; i < 16; ++i) m[i / 4][i % 4] = numbers[i];
  return m;
}

DepthMap read_depth(const std::string& path) {
  const auto file = OIIO::ImageInput::open(path);
  if (!file) throw std::runtime_error(OIIO::geterror());
  const OIIO::ImageSpec& spec = file->spec();
  DepthMap map;
  map.width = spec.width;
  map.height = spec.height;
  map.z_mm.resize(std::size_t(map.width) * map.height);
  if (!file->read_image(0, 0, 0, 1, OIIO::TypeFloat, map.z_mm.data())) {
    throw std::runtime_error(file->geterror());
  }
  map.to_camera = matrix(spec, "worldToCamera");
  map.to_ndc = matrix(spec, "worldToNDC");
  map.parallel = spec.get_string_attribute("projection") == "parallel";
  return map;
}

glm::dvec3 transformed(const glm::dmat4& m, const glm::dvec3& p) {
  const glm::dvec4 q = m * glm::dvec4(p, 1);
  return glm::dvec3(q) / q.w;
}

// The pixel's ray begins in the view plane (parallel) or at the eye; z is measured along it.
std::vector<glm::dvec3> points_of(const DepthMap& map) {
  const glm::dmat4 from_ndc = glm::inverse(map.to_ndc);
  const glm::dvec3 eye = transformed(glm::inverse(map.to_camera), {0, 0, 0});
  std::vector<glm::dvec3> points;
  for (int row = 0; row < map.height; ++row) {
    for (int column = 0; column < map.width; ++column) {
      const double z = map.z_mm[std::size_t(row) * map.width + column];
      if (!std::isfinite(z)) continue;
      const double x = 2 * (column + 0.5) / map.width - 1, y = 1 - 2 * (row + 0.5) / map.height;
      const glm::dvec3 near = transformed(from_ndc, {x, y, 0});
      const glm::dvec3 direction = glm::normalize(transformed(from_ndc, {x, y, 0.5}) - near);
      points.push_back((map.parallel ? near : eye) + z * direction);
    }
  }
  return points;
}

struct Mesh {
  std::vector<glm::dvec3> vertices;
  std::vector<glm::ivec3> triangles;
};

// Vertices and triangles of an .obj, with the middle of the bounding box at `position`.
Mesh read_mesh(const std::string& path, const glm::dvec3& position) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error(path + ": cannot be read");
  Mesh mesh;
  for (std::string line, word; std::getline(file, line);) {
    std::istringstream words(line);
    words >> word;
    if (word == "v")
      words >> mesh.vertices.emplace_back().x >> mesh.vertices.back().y >> mesh.vertices.back().z;
    if (word != "f") continue;
    glm::ivec3 corners;
    for (int i = 0; i < 3 && words >> word; ++i) corners[i] = std::stoi(word) - 1;
    mesh.triangles.push_back(corners);
  }
  glm::dvec3 low(HUGE_VAL), high(-HUGE_VAL);
  for (const auto& v : mesh.vertices) low = glm::min(low, v), high = glm::max(high, v);
  for (auto& v : mesh.vertices) v += position - 0.5 * (low + high);
  return mesh;
}

double segment_distance(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b) {
  const double along = glm::dot(p - a, b - a) / glm::dot(b - a, b - a);
  return glm::distance(p, a + std::clamp(along, 0.0, 1.0) * (b - a));
}

double triangle_distance(const glm::dvec3& p,
                         const glm::dvec3& a,
                         const glm::dvec3& b,
                         const glm::dvec3& c) {
  const glm::dvec3 normal = glm::normalize(glm::cross(b - a, c - a));
  const auto inside = [&](const glm::dvec3& from, const glm::dvec3& to) {
    return glm::dot(glm::cross(to - from, p - from), normal) >= 0;
  };
  if (inside(a, b) && inside(b, c) && inside(c, a)) return std::abs(glm::dot(p - a, normal));
  return std::min(
      {segment_distance(p, a, b), segment_distance(p, b, c), segment_distance(p, c, a)});
}

double distance(const Mesh& mesh, const glm::dvec3& p) {
  double nearest = HUGE_VAL;
  for (const auto& t : mesh.triangles) {
    nearest =
        std::min(nearest,
                 triangle_distance(
                     p, mesh.vertices.at(t[0]), mesh.vertices.at(t[1]), mesh.vertices.at(t[2])));
  }
  return nearest;
}

int main(int count, char** words) {
  if (count != 2 && count != 6) {
    std::cerr << "depth_to_points DEPTH.exr [MESH.obj X Y Z]\n";
    return 2;
  }
  try {
    const auto points = points_of(read_depth(words[1]));
    for (const auto& p : points) std::cout << p.x << ' ' << p.y << ' ' << p.z << '\n';
    if (count == 2 || points.empty()) return 0;
    const Mesh mesh =
        read_mesh(words[2], {std::stod(words[3]), std::stod(words[4]), std::stod(words[5])});
    std::vector<double> distances;
    for (const auto& p : points) distances.push_back(distance(mesh, p));
    std::sort(distances.begin(), distances.end());
    std::cerr << points.size() << " points, distance from the mesh: median "
              << distances[distances.size() / 2] << " mm, P95 "
              << distances[distances.size() * 95 / 100] << " mm\n";
  } catch (const std::exception& error) {
    std::cerr << "depth_to_points: " << error.what() << '\n';
    return 1;
  }
}
