#include "phantoms/import/mesh_parse.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cctype>
#include <stdexcept>
#include <string>

#include "base/text.h"
#include "phantoms/import/ply_check.h"
#include "phantoms/io/mesh_file.h"

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
