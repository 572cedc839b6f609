#include <cmath>
#include <glm/geometric.hpp>
#include <sstream>

#include "base/units.h"
#include "bench/exchange/export/writers.h"
#include "bench/exchange/files/out_file.h"
#include "bench/output/picture/colour_map.h"
#include "render/camera.h"

namespace wobblebench::bench {

namespace {

constexpr double kLargestStep_m = 3e-3;  // between neighbours of one triangle, in depth
constexpr double kColourLimit_mm = 3;    // of the signed error
constexpr std::uint32_t kNoTruth = 0x999999;

struct Vertex {
  glm::vec3 position_mm;
  glm::vec3 normal;
  std::uint8_t colour[3];
  float error_mm;
};

/// The surface of a depth map as triangles between neighbouring pixels.
class DepthMesh {
 public:
  DepthMesh(const Image<float>& depth_m, const render::Camera& camera)
      : depth_m_(depth_m), camera_(camera) {}

  bool has(int column, int row) const {
    return column >= 0 && row >= 0 && column < depth_m_.width && row < depth_m_.height &&
           !std::isnan(depth_m_.at(column, row));
  }
  glm::dvec3 point_m(int column, int row) const {
    return camera_.ray(column, row).at(depth_m_.at(column, row));
  }

  /// Towards the viewer, of neighbouring points; against the ray where there are none.
  glm::dvec3 normal(int column, int row) const {
    const glm::dvec3 across = difference(column, row, 1, 0), along = difference(column, row, 0, 1);
    glm::dvec3 normal = glm::cross(across, along);
    const glm::dvec3 ray = camera_.ray(column, row).direction;
    if (glm::dot(normal, normal) == 0) return -ray;
    normal = glm::normalize(normal);
    return glm::dot(normal, ray) > 0 ? -normal : normal;
  }

  /// Whether the four pixels from this one on are of one piece of surface.
  bool joins(int column, int row) const {
    double least = HUGE_VAL, most = -HUGE_VAL;
    for (const auto& [c, r] :
         {std::pair(0, 0), std::pair(1, 0), std::pair(0, 1), std::pair(1, 1)}) {
      if (!has(column + c, row + r)) return false;
      least = std::min<double>(least, depth_m_.at(column + c, row + r));
      most = std::max<double>(most, depth_m_.at(column + c, row + r));
    }
    return most - least <= kLargestStep_m;
  }

 private:
  bool is_near(int column, int row, int c, int r) const {
    return has(c, r) &&
           std::abs(double{depth_m_.at(c, r)} - depth_m_.at(column, row)) <= kLargestStep_m;
  }
  glm::dvec3 difference(int column, int row, int dc, int dr) const {
    const bool before = is_near(column, row, column - dc, row - dr);
    const bool behind = is_near(column, row, column + dc, row + dr);
    const glm::dvec3 high = behind ? point_m(column + dc, row + dr) : point_m(column, row);
    return high - (before ? point_m(column - dc, row - dr) : point_m(column, row));
  }

  const Image<float>& depth_m_;
  const render::Camera& camera_;
};

class PlyWriter : public ScanWriter {
 public:
  PlyWriter(const std::filesystem::path& path, const FileOptions& options, const ExportedScan& scan)
      : file_(path), scan_(scan), is_truth_(options.content == Content::truth) {}

  void add(const hw::PolarVolume&) override {}

  void finish(const ExportedPicture* picture) override {
    const Image<float>& depth_m =
        is_truth_ ? picture->truth.value().depth_m : picture->picture.depth_m;
    const DepthMesh mesh(depth_m, scan_.scene.view().camera);
    const std::vector<std::int32_t> corners = triangles(mesh, depth_m);
    file_.write(header(corners.size() / 3));
    for (const Vertex& vertex : vertices(mesh, *picture)) {
      file_.write_values(std::span(&vertex.position_mm.x, 3));
      file_.write_values(std::span(&vertex.normal.x, 3));
      file_.write_values(std::span<const std::uint8_t>(vertex.colour));
      file_.write_values(std::span(&vertex.error_mm, 1));
    }
    for (std::size_t i = 0; i < corners.size(); i += 3) {
      file_.write("\x03");
      file_.write_values(std::span(corners).subspan(i, 3));
    }
    file_.finish();
  }

 private:
  /// Numbers the vertices. Corners turn so that normals point to the viewer.
  std::vector<std::int32_t> triangles(const DepthMesh& mesh, const Image<float>& depth_m) {
    number_ = Image<std::int32_t>(depth_m.width, depth_m.height, -1);
    for (int row = 0; row < depth_m.height; ++row) {
      for (int column = 0; column < depth_m.width; ++column) {
        if (mesh.has(column, row)) number_.at(column, row) = count_++;
      }
    }
    std::vector<std::int32_t> corners;
    const bool flipped = scan_.scene.view().camera.flipped;
    for (int row = 0; row + 1 < depth_m.height; ++row) {
      for (int column = 0; column + 1 < depth_m.width; ++column) {
        if (!mesh.joins(column, row)) continue;
        const std::int32_t a = number_.at(column, row), b = number_.at(column + 1, row);
        const std::int32_t c = number_.at(column, row + 1), d = number_.at(column + 1, row + 1);
        if (flipped) {
          corners.insert(corners.end(), {a, b, c, b, d, c});
        } else {
          corners.insert(corners.end(), {a, c, b, b, c, d});
        }
      }
    }
    return corners;
  }

  std::string header(std::size_t faces) const {
    std::ostringstream text;
    text << "ply\nformat binary_little_endian 1.0\ncomment " << (is_truth_ ? "true" : "found")
         << " surface, probe frame, mm; error_mm is found less true depth along the pixel's ray, "
            "nan where one is missing; colours show it from -3 mm, blue, to 3 mm, red\n";
    if (!scan_.simulated) text << "comment recording of hardware: the true surface is not known\n";
    text << "element vertex " << count_ << "\n";
    for (const char* name : {"x", "y", "z", "nx", "ny", "nz"}) {
      text << "property float " << name << "\n";
    }
    for (const char* name : {"red", "green", "blue"}) text << "property uchar " << name << "\n";
    text << "property float error_mm\nelement face " << faces
         << "\nproperty list uchar int vertex_indices\nend_header\n";
    return text.str();
  }

  float error_mm(const ExportedPicture& picture, int column, int row) const {
    if (!picture.truth) return kNoSurface;
    const double error_m =
        double{picture.picture.depth_m.at(column, row)} - picture.truth->depth_m.at(column, row);
    return static_cast<float>(error_m / kMillimetre);
  }

  std::vector<Vertex> vertices(const DepthMesh& mesh, const ExportedPicture& picture) const {
    std::vector<Vertex> vertices;
    for (int row = 0; row < number_.height; ++row) {
      for (int column = 0; column < number_.width; ++column) {
        if (number_.at(column, row) < 0) continue;
        Vertex vertex{glm::vec3(mesh.point_m(column, row) / kMillimetre), {}, {}, 0};
        vertex.normal =
            is_truth_ ? picture.truth->normal.at(column, row) : glm::vec3(mesh.normal(column, row));
        vertex.error_mm = error_mm(picture, column, row);
        const glm::vec3 colour = std::isnan(vertex.error_mm)
                                     ? display_colour(kNoTruth)
                                     : diverging(0.5 + 0.5 * vertex.error_mm / kColourLimit_mm);
        for (int i = 0; i < 3; ++i) {
          vertex.colour[i] = static_cast<std::uint8_t>(std::lround(255 * colour[i]));
        }
        vertices.push_back(vertex);
      }
    }
    return vertices;
  }

  OutFile file_;
  const ExportedScan& scan_;
  bool is_truth_;
  Image<std::int32_t> number_;  ///< of a pixel's vertex; -1: it has none
  std::int32_t count_ = 0;
};

}  // namespace

std::unique_ptr<ScanWriter> make_ply_writer(const std::filesystem::path& path,
                                            const FileOptions& options,
                                            const ExportedScan& scan) {
  return std::make_unique<PlyWriter>(path, options, scan);
}

}  // namespace wobblebench::bench
