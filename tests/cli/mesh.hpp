#pragma once
// Meshes for the pages of `view`, and whether this build reads any.

#include "cli/program.hpp"

namespace manycontact::cli {

inline std::string mesh_reader() {
  return (std::filesystem::path(MANYCONTACT_BINARY).parent_path() / "manycontact-mesh").string();
}
inline bool reads_meshes() { return std::filesystem::exists(mesh_reader()); }

/// Returns COLLADA: a triangle (0 0 0), (4 0 0), (0 5 0) named g, and the scene's nodes. `asset`: unit and axes.
inline std::string collada(const std::string& asset, const std::string& nodes, const std::string& corners = "0 1 2") {
  return R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset>)" +
         asset + R"(</asset>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="a" count="9">0 0 0 4 0 0 0 5 0</float_array><technique_common>
<accessor source="#a" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>)" +
         corners + R"(</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s">)" +
         nodes + R"(</visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
}

}  // namespace manycontact::cli
