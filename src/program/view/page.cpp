// Writes the page. It consists of its parts (HTML, CSS, scripts), and of JSON with the scene and the recorded frames,
// whose numbers are in base64.

#include "page.hpp"

#include <bit>
#include <ostream>

#include "../command/command.hpp"
#include "../files/output_file.hpp"
#include "../text/table.hpp"

namespace manycontact::cli {

static_assert(std::endian::native == std::endian::little, "the page reads little endian numbers");

namespace {

constexpr double kLargestPage = 500e6;  // larger pages overload browsers [bytes]

std::string base64(const unsigned char* bytes, std::size_t size) {
  static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((size + 2) / 3 * 4);
  for (std::size_t i = 0; i < size; i += 3) {
    const std::size_t n = std::min<std::size_t>(3, size - i);
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k) bits = bits << 8 | (k < n ? bytes[i + k] : 0U);
    for (std::size_t k = 0; k < 4; ++k) out += k <= n ? kDigits[bits >> (18 - 6 * k) & 63] : '=';
  }
  return out;
}

std::string place(const Scene& scene, const Attachment& at) {
  if (at.robot < 0) return at.frame.empty() ? "world" : "world (" + at.frame + ")";
  return scene.robots[at.robot].name + (at.frame.empty() ? "" : "/" + at.frame);
}

Json contacts_of(const Recording& r) {
  Json list = Json::array();
  for (std::size_t c = 0; c < r.scene->contacts.size(); ++c) {
    const Contact& contact = r.scene->contacts[c];
    list.push_back({{"name", contact.name},
                    {"type", to_string(contact.type)},
                    {"friction", r.friction[c]},
                    {"a", place(*r.scene, contact.A)},
                    {"b", place(*r.scene, contact.B)}});
  }
  return list;
}

Json frames_of(const Recording& r) {
  return {{"count", r.t.size()},
          {"t", base64_of(r.t)},
          {"kinetic", base64_of(r.kinetic)},
          {"potential", base64_of(r.potential)},
          {"violation_position", base64_of(r.violation_position)},
          {"violation_velocity", base64_of(r.violation_velocity)},
          {"positions", base64_of(r.positions)},
          {"quaternions", base64_of(r.quaternions)},
          {"islands", base64_of(r.islands)},
          {"points", base64_of(r.points)},
          {"held", base64_of(r.held)},
          {"normals", base64_of(r.normals)},
          {"forces", base64_of(r.forces)},
          {"wrenches", base64_of(r.wrenches)},
          {"springs", base64_of(r.springs)},
          {"flags", base64_of(r.flags)}};
}

// Escapes '<' in JSON text inside <script>, because a text "</script>" would end the element.
std::string script_safe(const std::string& json) {
  std::string out;
  for (const char c : json) out += c == '<' ? std::string("\\u003c") : std::string(1, c);
  return out;
}

// Writes the HTML template, in which each {{name}} is replaced by the part of this name.
void write_page(const PageParts& parts, std::string_view scene, std::ostream& out) {
  const std::pair<std::string_view, std::string_view> fill[] = {
      {"{{css}}", parts.css}, {"{{three}}", parts.three}, {"{{scene}}", scene}, {"{{script}}", parts.script}};
  std::string_view html = parts.html;
  for (const auto& [name, text] : fill) {
    const std::size_t at = html.find(name);
    out << html.substr(0, at) << text;
    html.remove_prefix(at + name.size());
  }
  out << html;
}

void check_size(const Recording& r) {
  const double frames = static_cast<double>(r.t.size());
  const double bytes = 4. / 3 *
                       (4. * static_cast<double>(r.positions.size()) + 2. * static_cast<double>(r.quaternions.size()) +
                        20. * static_cast<double>(r.points.size()) +  // points, normals, forces, held
                        4. * static_cast<double>(r.wrenches.size() + r.springs.size()));
  if (bytes > kLargestPage)
    throw UsageError("the page would have " + number(bytes / 1e6) + " MB with " + number(frames, 6) +
                     " frames, expected at most " + number(kLargestPage / 1e6) +
                     " MB: choose a shorter motion or fewer robots");
}

}  // namespace

template <class T>
std::string base64_of(const std::vector<T>& list) {
  return base64(reinterpret_cast<const unsigned char*>(list.data()), list.size() * sizeof(T));
}
template std::string base64_of(const std::vector<float>&);
template std::string base64_of(const std::vector<std::uint32_t>&);

std::vector<std::string> write_view(const SceneFile& file, Recording& recording, const std::string& path) {
  finish(recording);
  check_size(recording);
  std::vector<std::string> notes, meshes;
  Json scene = {{"name", file.scene.name}};
  scene.update(shapes_of(file, notes, meshes));
  check_unread("the page", path, meshes);
  scene["contacts"] = contacts_of(recording);
  scene["wrenches"] = file.scene.wrenches.size();
  scene["springs"] = file.scene.springs.size();
  scene["frames"] = frames_of(recording);
  scene["notes"] = notes;
  const std::string json =
      script_safe(scene.dump(-1, ' ', false, Json::error_handler_t::replace));  // names may contain any bytes

  OutputFile page(path);
  write_page(page_parts(), json, page.stream());
  page.close();
  return notes;
}

}  // namespace manycontact::cli
