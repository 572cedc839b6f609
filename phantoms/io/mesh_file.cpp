#include "phantoms/io/mesh_file.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cctype>
#include <cmath>
#include <stdexcept>
#include <string>

#include "base/text.h"
#include "phantoms/io/ply_check.h"

namespace wobblebench::phantoms {
namespace {

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

void append(const aiMesh& from, TriangleMesh& to) {
  const auto first = std::uint32_t(to.vertices.size());
  for (unsigned i = 0; i < from.mNumVertices; ++i) {
    const aiVector3D& v = from.mVertices[i];
    if (!std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.z)) {
      throw std::invalid_argument("holds a vertex that is not finite");
    }
    to.vertices.emplace_back(v.x, v.y, v.z);
  }
  for (unsigned i = 0; i < from.mNumFaces; ++i) {
    const aiFace& face = from.mFaces[i];
    if (face.mNumIndices != 3) continue;
    TriangleMesh::Triangle t{};
    for (int corner = 0; corner < 3; ++corner) t[corner] = first + face.mIndices[corner];
    to.triangles.push_back(t);
  }
}

}  // namespace

std::string lower_case_extension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(), [](unsigned char c) {
    return char(std::tolower(c));
  });
  return extension;
}

TriangleMesh read_mesh(const std::filesystem::path& path) {
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
  TriangleMesh mesh;
  for (unsigned i = 0; i < scene->mNumMeshes; ++i) append(*scene->mMeshes[i], mesh);
  if (mesh.triangles.empty()) throw std::invalid_argument("has no triangles");
  return mesh;
}

}  // namespace wobblebench::phantoms
