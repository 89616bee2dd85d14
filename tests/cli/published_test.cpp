// Every command of src/doc/published.md succeeds, and its number is as near to the published one as the page states.

#include <cmath>
#include <map>
#include <set>

#include "cli/program.hpp"

namespace manycontact::cli {
namespace {

// Contains one row of the page's table.
struct PublishedRow {
  std::string what, theirs, ours, error, read, command;
};

std::string trimmed(const std::string& text) {
  const std::size_t begin = text.find_first_not_of(" `"), end = text.find_last_not_of(" `");
  return begin == std::string::npos ? "" : text.substr(begin, end - begin + 1);
}

std::vector<PublishedRow> published_rows() {
  std::vector<PublishedRow> rows;
  std::string problem;
  for (const std::string& line : lines_of(read_text(MANYCONTACT_SOURCE_DIR "/src/doc/published.md"))) {
    if (!line.starts_with("|") || line.find("bin/manycontact ") == std::string::npos) continue;
    std::vector<std::string> cells;
    std::istringstream stream(line.substr(1));
    for (std::string cell; std::getline(stream, cell, '|');) cells.push_back(trimmed(cell));
    if (cells.size() != 8) {
      ADD_FAILURE() << "not eight cells: " << line;
      continue;
    }
    if (!cells[0].empty()) problem = cells[0];
    rows.push_back({problem + ": " + cells[2], cells[3], cells[4], cells[5], cells[6], cells[7]});
  }
  return rows;
}

// Returns the words of a command as a shell splits them: at blanks, but not within double quotes.
std::vector<std::string> words_of(const std::string& command) {
  std::vector<std::string> words;
  std::string word;
  bool quoted = false;
  for (const char c : command + " ") {
    if (c == '"') {
      quoted = !quoted;
    } else if (c != ' ' || quoted) {
      word += c;
    } else if (!word.empty()) {
      words.push_back(word);
      word.clear();
    }
  }
  return words;
}

// Returns one unit in the last digit of a number as written: "0.1229" has 1e-4, "4" has 0.
double last_digit(const std::string& number) {
  const std::size_t point = number.find('.');
  return point == std::string::npos ? 0 : std::pow(10.0, -static_cast<double>(number.size() - point - 1));
}

// Returns the value at `read` in the output: a JSON pointer, or a column of a CSV, in its last row.
double number_at(const std::string& output, const std::string& read) {
  if (read.starts_with("/")) return nlohmann::json::parse(output).at(nlohmann::json::json_pointer(read)).get<double>();
  const std::vector<std::string> lines = lines_of(output);
  if (lines.empty()) throw std::runtime_error("nothing was written");
  std::istringstream names(lines.front()), cells(lines.back());
  for (std::string name, cell; std::getline(names, name, ',') && std::getline(cells, cell, ',');)
    if (name == read) return std::stod(cell);
  throw std::runtime_error("no column " + read);
}

class Published : public Program {};

TEST_F(Published, AsNearAsThePageSays) {
  const std::vector<PublishedRow> rows = published_rows();
  ASSERT_GE(rows.size(), 20u) << "has the way the table is written changed?";
  std::map<std::string, std::string> outputs;  // of commands: rows share them
  std::set<std::string> problems;
  for (const PublishedRow& row : rows) {
    SCOPED_TRACE(row.what);
    problems.insert(row.what.substr(0, row.what.find(':')));
    if (!outputs.contains(row.command)) {
      std::vector<std::string> words = words_of(row.command);
      ASSERT_EQ(words.front(), "build/release/bin/manycontact");
      words.erase(words.begin());
      for (std::string& word : words)
        if (word.starts_with("models/")) word = MANYCONTACT_SOURCE_DIR "/" + word;
      const Outcome outcome = run(words);
      ASSERT_EQ(outcome.status, 0) << outcome.err;
      outputs[row.command] = outcome.out;
    }
    double got = NAN;
    ASSERT_NO_THROW(got = number_at(outputs.at(row.command), row.read)) << row.read;
    const double theirs = std::stod(row.theirs), ours = std::stod(row.ours), error = std::stod(row.error);
    EXPECT_NEAR(got, theirs, error * (1 + 1e-9));
    EXPECT_NEAR(got, ours, last_digit(row.ours));
    // The error is between the published number and ours, at most twice that.
    EXPECT_LE(error, 2 * std::max({std::abs(ours - theirs), last_digit(row.ours), last_digit(row.theirs)}));
  }
  EXPECT_GE(problems.size(), 8u);
}

// The page runs every model of models/published; a task runs its scene.
TEST_F(Published, EveryModelHasItsRow) {
  std::string commands;
  for (const PublishedRow& row : published_rows()) commands += row.command + "\n";
  for (const auto& entry : std::filesystem::directory_iterator(model("published"))) {
    const std::string name = entry.path().filename().string();
    if (name.ends_with(".xml") && !name.ends_with("_scene.xml")) expect_contains(commands, "models/published/" + name);
  }
}

}  // namespace
}  // namespace manycontact::cli
