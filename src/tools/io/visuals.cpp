#include "manycontact/io/visuals.hpp"

#include <map>

#include "manycontact/spatial/rpy.hpp"
#include "xml.hpp"

namespace manycontact {
namespace {

SE3<double> origin_of(const io::Element& visual) {
  SE3<double> at;
  const auto origin = visual.child("origin");
  if (!origin) return at;
  Vec3<double> rpy = Vec3<double>::Zero();
  (void)origin->read("xyz", at.p);
  if (origin->read("rpy", rpy)) at.R = rotation_of_rpy(rpy[0], rpy[1], rpy[2]);
  return at;
}

using Colour = std::array<double, 4>;
using Colours = std::map<std::string, Colour>;  // key: the name of the <material>

std::optional<Colour> colour_of(const io::Element& parent, const Colours& named) {
  const auto material = parent.child("material");
  if (!material) return {};
  if (const auto color = material->child("color"))
    if (const auto rgba = color->numbers<4>("rgba")) return rgba;
  const auto found = named.find(material->optional("name", ""));
  return found == named.end() ? std::nullopt : std::optional<Colour>(found->second);
}

// Reads a shape into `out`. Returns false if it is not a shape of URDF 1.0.
bool read_shape(const io::Element& geometry, Visual& out) {
  const auto inside = geometry.child();
  const std::string name = inside ? inside->name() : "";
  std::array<double, 3> size{};
  if (name == "box") {
    out.shape = VisualShape::kBox;
    (void)inside->required("size");
    size = *inside->numbers<3>("size");
  } else if (name == "cylinder") {
    out.shape = VisualShape::kCylinder;
    size = {inside->required_number("radius"), inside->required_number("length"), 0};
  } else if (name == "sphere") {
    out.shape = VisualShape::kSphere;
    size = {inside->required_number("radius"), 0, 0};
  } else if (name == "mesh") {
    out.shape = VisualShape::kMesh;
    out.mesh = inside->required("filename");
    size = inside->numbers<3>("scale").value_or(std::array<double, 3>{1, 1, 1});
  } else {
    return false;
  }
  out.size = {size[0], size[1], size[2]};
  return true;
}

}  // namespace

std::vector<Visual> load_visuals(const std::string& urdf) {
  const io::XmlFile file(urdf, io::read_file_of(urdf, "a URDF file"), "robot");
  const io::Element robot = file.root();

  Colours named;
  for (const io::Element& material : robot.children("material"))
    if (const auto color = material.child("color"))
      if (const auto rgba = color->numbers<4>("rgba")) named[material.optional("name", "")] = *rgba;

  std::vector<Visual> visuals;
  for (const io::Element& link : robot.children("link"))
    for (const io::Element& visual : link.children("visual")) {
      Visual out;
      const auto geometry = visual.child("geometry");
      if (!geometry || !read_shape(*geometry, out)) continue;
      out.link = link.required("name");
      out.placement = origin_of(visual);
      out.colour = colour_of(visual, named);
      visuals.push_back(std::move(out));
    }
  return visuals;
}

}  // namespace manycontact
