// manycontact-mesh FILE reads an STL, OBJ or COLLADA file with assimp and writes its triangles to standard output, nine
// floats each (three vertices, native byte order). If it fails, it exits with status 3 and writes the reason instead.
// It is a separate program with limited time and memory, because assimp crashes on malicious files, such as a COLLADA
// node that contains itself, or takes all memory.

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <assimp/Importer.hpp>
#include <cctype>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>

namespace {

void limit(auto resource, rlim_t most) {
  rlimit now{};
  if (getrlimit(resource, &now) != 0) return;
  now.rlim_cur = std::min(most, now.rlim_cur);
  (void)setrlimit(resource, &now);
}

int refuse(const std::string& why) {
  std::fputs(why.c_str(), stdout);
  return 3;
}

void write(const aiMesh& part) {
  for (unsigned k = 0; k < part.mNumFaces; ++k) {
    const aiFace& face = part.mFaces[k];
    if (face.mNumIndices != 3) continue;  // the face is a line or a point
    for (unsigned i = 0; i < 3; ++i) {
      if (face.mIndices[i] >= part.mNumVertices) std::abort();
      const aiVector3D& p = part.mVertices[face.mIndices[i]];
      const std::array<float, 3> vertex{p.x, p.y, p.z};
      std::fwrite(vertex.data(), sizeof vertex, 1, stdout);
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return refuse("usage: manycontact-mesh FILE");
  alarm(60);  // seconds
  limit(RLIMIT_CORE, 0);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // sanitizers need terabytes of address space
  limit(RLIMIT_AS, rlim_t(1) << 32);
#endif

  std::string format = std::filesystem::path(argv[1]).extension().string();
  std::transform(format.begin(), format.end(), format.begin(), [](unsigned char c) { return std::tolower(c); });
  if (format != ".dae" && format != ".obj" && format != ".stl")
    return refuse("is no mesh that can be read, expected a file .dae, .obj or .stl");

  // Nodes place the meshes, in metres according to <unit>. The file's <up_axis> is ignored, as in rviz.
  Assimp::Importer importer;
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const aiScene* scene = importer.ReadFile(argv[1], 0);
  if (scene && std::none_of(scene->mMeshes, scene->mMeshes + scene->mNumMeshes, [](auto* m) { return m->HasFaces(); }))
    return refuse("has no triangles, expected at least one triangle");
  if (scene) scene = importer.ApplyPostProcessing(aiProcess_Triangulate | aiProcess_PreTransformVertices);
  if (!scene) return refuse(std::string("cannot be read, expected a mesh; assimp: ") + importer.GetErrorString());
  for (unsigned k = 0; k < scene->mNumMeshes; ++k) write(*scene->mMeshes[k]);
  return 0;
}
