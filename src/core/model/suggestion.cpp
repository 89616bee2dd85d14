#include "manycontact/model/suggestion.hpp"

#include <algorithm>
#include <numeric>
#include <stdexcept>

namespace manycontact {

std::string quote(std::string_view text) {
  constexpr std::size_t kMost = 80;
  if (text.size() <= kMost) return "'" + std::string(text) + "'";
  return "'" + std::string(text.substr(0, kMost)) + "...'";
}

namespace {

// Returns the Levenshtein distance of a and b, computed one row of its table at a time.
std::size_t distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t change = diagonal + (a[i - 1] != b[j - 1]);
      diagonal = row[j];
      row[j] = std::min({change, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row.back();
}

// Sorts the words of a name alphabetically, so that "knee_left" and "left_knee" agree.
std::string in_order(const std::string& name) {
  std::vector<std::string> words(1);
  for (const char c : name) {
    if (c == '_' || c == '-' || c == '/' || c == ' ')
      words.emplace_back();
    else
      words.back() += c;
  }
  std::sort(words.begin(), words.end());
  std::string out;
  for (const std::string& word : words) out += word + '_';
  return out;
}

// Returns how different two names are: the number of letters to change, or, if it is less, one plus this number after
// sorting the words of both. The result is 1 if b contains a, 0 if they are equal.
std::size_t difference(const std::string& a, const std::string& b) {
  if (a.size() > 2 && b.find(a) != std::string::npos) return a == b ? 0 : 1;
  return std::min(distance(a, b), distance(in_order(a), in_order(b)) + 1);
}

template <class Named>
std::vector<std::string> names_of(const std::vector<Named>& list) {
  std::vector<std::string> names;
  for (const Named& item : list) names.push_back(item.name);
  return names;
}

}  // namespace

std::string suggestion(const std::string& name, const std::vector<std::string>& known) {
  if (known.empty()) return "since there are no names to choose from";
  if (known.size() <= 8) {
    std::string list = known.size() == 1 ? "expected " : "expected one of ";
    for (std::size_t i = 0; i < known.size(); ++i) list += (i ? ", " : "") + quote(known[i]);
    return list;
  }
  const std::string* best = nullptr;
  std::size_t least = 0;
  for (const std::string& k : known) {
    if (k.size() > 200 || name.size() > 200) continue;
    const std::size_t d = difference(name, k);
    if (!best || d < least) best = &k, least = d;
  }
  return best ? "did you mean " + quote(*best) + "?" : "expected one of " + std::to_string(known.size()) + " names";
}

std::string no_robot(const Scene& scene, const std::string& name) {
  return "there is no robot " + quote(name) + ", " + suggestion(name, names_of(scene.robots));
}

int robot_called(const Scene& scene, const std::string& name) {
  const auto found = scene.robot_index.find(name);
  if (found == scene.robot_index.end()) throw std::invalid_argument(no_robot(scene, name));
  return found->second;
}

int contact_called(const Scene& scene, const std::string& name) {
  const auto found = scene.contact_index.find(name);
  if (found != scene.contact_index.end()) return found->second;
  throw std::invalid_argument("there is no contact " + quote(name) + ", " + suggestion(name, names_of(scene.contacts)));
}

int contact_at(const Scene& scene, int number, const char* function) {
  const int count = static_cast<int>(scene.contacts.size());
  if (number < 0 || number >= count)
    throw std::invalid_argument(std::string(function) + ": there is no contact " + std::to_string(number) +
                                ", the scene has " + std::to_string(count) + " contacts");
  return number;
}

std::string no_frame(const std::string& robot, const Model& model, const std::string& name) {
  return "robot " + quote(robot) + " has no frame " + quote(name) + ", " + suggestion(name, names_of(model.frames));
}

std::string no_joint(const Model& model, const std::string& name) {
  const auto among = [&](const std::vector<std::string>& list) {
    return std::find(list.begin(), list.end(), name) != list.end();
  };
  if (among(model.notes.locked)) return "joint " + quote(name) + " is locked, expected a joint that moves";
  if (among(model.notes.merged)) return "joint " + quote(name) + " is fixed, expected a joint that moves";
  return "the robot has no joint " + quote(name) + ", " + suggestion(name, names_of(model.joints));
}

}  // namespace manycontact
