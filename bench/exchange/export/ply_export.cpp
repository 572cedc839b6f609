#include <cmath>
#include <glm/geometric.hpp>
#include <sstream>

#include "base/units.h"
#include "bench/exchange/export/depth_mesh.h"
#include "bench/exchange/export/writers.h"
#include "bench/exchange/files/out_file.h"
#include "bench/output/picture/colour_map.h"

namespace wobblebench::bench {

namespace {

constexpr double kColourLimit_mm = 3;  // of the signed error
constexpr std::uint32_t kNoTruth = 0x999999;

struct Vertex {
  glm::vec3 position_mm;
  glm::vec3 normal;
  std::uint8_t colour[3];
  float error_mm;
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
    const std::vector<std::int32_t> corners = mesh.corners();
    file_.write(header(mesh.pixels().size(), corners.size() / 3));
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
  std::string header(std::size_t count, std::size_t faces) const {
    std::ostringstream text;
    text << "ply\nformat binary_little_endian 1.0\ncomment " << (is_truth_ ? "true" : "found")
         << " surface, probe frame, mm; error_mm is found less true depth along the pixel's ray, "
            "nan where one is missing; colours show it from -3 mm, blue, to 3 mm, red\n";
    if (!scan_.simulated) text << "comment recording of hardware: the true surface is not known\n";
    text << "element vertex " << count << "\n";
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
    for (const glm::ivec2& pixel : mesh.pixels()) {
      Vertex vertex{glm::vec3(mesh.point_m(pixel) / kMillimetre), {}, {}, 0};
      vertex.normal =
          is_truth_ ? picture.truth->normal.at(pixel.x, pixel.y) : glm::vec3(mesh.normal(pixel));
      vertex.error_mm = error_mm(picture, pixel.x, pixel.y);
      const glm::vec3 colour = std::isnan(vertex.error_mm)
                                   ? display_colour(kNoTruth)
                                   : diverging(0.5 + 0.5 * vertex.error_mm / kColourLimit_mm);
      for (int i = 0; i < 3; ++i) {
        vertex.colour[i] = static_cast<std::uint8_t>(std::lround(255 * colour[i]));
      }
      vertices.push_back(vertex);
    }
    return vertices;
  }

  OutFile file_;
  const ExportedScan& scan_;
  bool is_truth_;
};

}  // namespace

std::unique_ptr<ScanWriter> make_ply_writer(const std::filesystem::path& path,
                                            const FileOptions& options,
                                            const ExportedScan& scan) {
  return std::make_unique<PlyWriter>(path, options, scan);
}

}  // namespace wobblebench::bench
