#include "apps/scene_text.h"

#include "apps/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string_view>

namespace apps {

namespace {

constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";

using Paths = std::vector<std::filesystem::path>;

/// One name for one file, as far as that can be known.
std::filesystem::path identity(const std::filesystem::path& file)
{
  std::error_code failed;
  const std::filesystem::path result = std::filesystem::weakly_canonical(file, failed);
  return failed ? file : result;
}

/// Reads lines of one file into a scene text.
class Scanner {
public:
  /// \param sections  those open where the file is included
  /// \param open      this file and those that include it
  Scanner(SceneText& scene, std::string name, std::filesystem::path folder,
          std::vector<std::string> sections, Paths open)
      : scene_(scene), name_(std::move(name)), folder_(std::move(folder)),
        sections_(std::move(sections)), open_(std::move(open)), n_outer_(sections_.size())
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
    if (sections_.size() > n_outer_)
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
    else if (line == "end" && sections_.size() > n_outer_)
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
    if (file.empty()) {
      error("write 'include FILE'");
      return;
    }
    const std::filesystem::path path = folder_ / file;
    Paths open = open_;
    open.push_back(identity(path));
    if (std::ranges::find(open_, open.back()) != open_.end()) {
      error(
          fmt::format("'include {}': the file includes itself, directly or through others", file));
      return;
    }
    try {
      const std::string text = read_text_file(path);
      Scanner(scene_, path.lexically_normal().string(), path.parent_path(), sections_, open)
          .scan(text);
    } catch (const std::invalid_argument& failure) {
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
  std::vector<std::string> sections_;
  Paths open_;
  std::size_t n_outer_;
  std::string place_;
};

} // namespace

std::string SceneEntry::section() const
{
  std::string result;
  for (const std::string& part : sections)
    result += (result.empty() ? "" : "/") + part;
  return result;
}

std::string SceneEntry::path() const
{
  return sections.empty() ? key : section() + "/" + key;
}

std::string read_text_file(const std::filesystem::path& file)
{
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored))
    throw std::invalid_argument(fmt::format("{} is a folder, not a file", file.string()));
  std::ifstream stream(file, std::ios::binary);
  if (!stream)
    throw std::invalid_argument(fmt::format("{} cannot be read: there is no such file, or you may "
                                            "not read it",
                                            file.string()));
  std::ostringstream stored;
  stored << stream.rdbuf();
  std::string text = stored.str();
  if (text.starts_with(byte_order_mark))
    text.erase(0, byte_order_mark.size());
  return text;
}

SceneText scan_scene(const std::string& text, const std::string& name,
                     const std::filesystem::path& folder)
{
  SceneText scene;
  Scanner(scene, name, folder, {}, {identity(name)}).scan(text);
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
    throw std::invalid_argument(fmt::format("--set \"{}\": write \"Section/Key = value\"", text));
  if (text.find_first_of("#\n\r") != std::string::npos || trimmed(text).ends_with('\\'))
    throw std::invalid_argument(fmt::format(
        "--set \"{}\": '#', line breaks and a backslash at the end cannot stand in a scene", text));
  SceneEntry entry;
  entry.key = path.back();
  path.pop_back();
  entry.sections = path;
  entry.value = trimmed(text.substr(equals + 1));
  entry.place = "--set";
  return entry;
}

} // namespace apps
