#include "apps/scene_text.h"

#include "apps/text.h"

#include <fmt/format.h>

#include <fstream>
#include <sstream>
#include <stdexcept>

namespace apps {

namespace {

constexpr int deepest_include = 8;

/// Reads lines of one file into a scene text.
class Scanner {
public:
  Scanner(SceneText& scene, std::string name, std::filesystem::path folder, int depth)
      : scene_(scene), name_(std::move(name)), folder_(std::move(folder)), depth_(depth)
  {
  }

  void scan(const std::string& text)
  {
    std::istringstream stream(text);
    std::string line, joined;
    int number = 0, first = 0;
    while (std::getline(stream, line)) {
      ++number;
      if (joined.empty())
        first = number;
      line = trimmed(line.substr(0, line.find('#')));
      const bool continues = line.ends_with('\\');
      if (continues)
        line.pop_back();
      joined += (joined.empty() ? "" : " ") + trimmed(line);
      if (continues)
        continue;
      place_ = fmt::format("{}:{}", name_, first);
      statement(trimmed(joined));
      joined.clear();
    }
    place_ = fmt::format("{}:{}", name_, number);
    if (!joined.empty())
      error("the file ends in the middle of a continued line");
    if (!sections_.empty())
      error(fmt::format("'subsection {}' is not closed by 'end'", sections_.back()));
  }

private:
  void statement(const std::string& line)
  {
    if (line.empty())
      return;
    const std::size_t space = std::min(line.find_first_of(" \t"), line.size());
    const std::string word = line.substr(0, space), rest = trimmed(line.substr(space));
    if (word == "subsection" && !rest.empty())
      sections_.push_back(rest);
    else if (line == "end" && !sections_.empty())
      sections_.pop_back();
    else if (line == "end")
      error("'end' without a 'subsection' to close");
    else if (word == "include")
      include(rest);
    else if (word == "set")
      set(rest);
    else
      error(fmt::format("'{}' is neither 'set KEY = VALUE', 'subsection NAME', 'end' nor "
                        "'include FILE'",
                        line));
  }

  void set(const std::string& rest)
  {
    const std::size_t equals = rest.find('=');
    const std::string key = trimmed(rest.substr(0, std::min(equals, rest.size())));
    if (equals == std::string::npos || key.empty()) {
      error("write 'set KEY = VALUE'");
      return;
    }
    scene_.entries.push_back({sections_, key, trimmed(rest.substr(equals + 1)), place_});
  }

  void include(const std::string& file)
  {
    const std::filesystem::path path = folder_ / file;
    if (depth_ >= deepest_include) {
      error(fmt::format("'include {}': files include each other", file));
      return;
    }
    try {
      const std::string text = read_text_file(path);
      Scanner(scene_, path.lexically_normal().string(), path.parent_path(), depth_ + 1).scan(text);
    } catch (const std::runtime_error& failure) {
      error(fmt::format("'include {}': {}", file, failure.what()));
    }
  }

  void error(const std::string& message)
  {
    scene_.diagnostics.push_back({Diagnostic::Kind::error, place_, message});
  }

  SceneText& scene_;
  std::string name_;
  std::filesystem::path folder_;
  int depth_;
  std::string place_;
  std::vector<std::string> sections_;
};

} // namespace

std::string SceneEntry::path() const
{
  std::string result;
  for (const std::string& section : sections)
    result += section + "/";
  return result + key;
}

std::string read_text_file(const std::filesystem::path& file)
{
  if (std::filesystem::is_directory(file))
    throw std::runtime_error(fmt::format("{} is a folder, not a file", file.string()));
  std::ifstream stream(file, std::ios::binary);
  if (!stream)
    throw std::runtime_error(fmt::format("{} cannot be read: there is no such file, or you may not "
                                         "read it",
                                         file.string()));
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

SceneText scan_scene(const std::string& text, const std::string& name,
                     const std::filesystem::path& folder)
{
  SceneText scene;
  Scanner(scene, name, folder, 0).scan(text);
  return scene;
}

SceneText read_scene_text(const std::filesystem::path& file)
{
  return scan_scene(read_text_file(file), file.string(), file.parent_path());
}

SceneEntry override_entry(const std::string& text)
{
  const std::size_t equals = text.find('=');
  std::vector<std::string> path = split(text.substr(0, std::min(equals, text.size())), '/');
  if (equals == std::string::npos || path.empty() || path.back().empty())
    throw std::invalid_argument(
        fmt::format("--set \"{}\": write \"Section/Key = value\"", text));
  SceneEntry entry;
  entry.key = path.back();
  path.pop_back();
  entry.sections = path;
  entry.value = trimmed(text.substr(equals + 1));
  entry.place = "--set";
  return entry;
}

} // namespace apps
