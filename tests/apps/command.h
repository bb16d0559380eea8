#pragma once
#include "apps/process.h"
#include "apps/scene_text.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

/// Running the program as a user does.
namespace command {

/// A new folder, removed with all that is in it at the end.
class Folder {
public:
  Folder()
  {
    std::string name = (std::filesystem::temp_directory_path() / "mastic-test-XXXXXX").string();
    if (!::mkdtemp(name.data()))
      throw std::runtime_error("no folder for the test");
    path_ = name;
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  Folder(const Folder&) = delete;

  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  const std::filesystem::path& path() const { return path_; }

  void write(const std::string& name, const std::string& text) const
  {
    std::ofstream(path_ / name, std::ios::binary) << text;
  }
  std::string read(const std::string& name) const { return apps::read_text_file(path_ / name); }
  bool has(const std::string& name) const { return std::filesystem::exists(path_ / name); }

  /// Names of all files in a folder below this one, with those in its folders.
  std::vector<std::string> files(const std::string& below = ".") const
  {
    std::vector<std::string> names;
    if (has(below))
      for (const auto& each : std::filesystem::recursive_directory_iterator(path_ / below))
        if (each.is_regular_file())
          names.push_back(each.path().lexically_relative(path_ / below).string());
    return names;
  }

private:
  std::filesystem::path path_;
};

/// The command line that runs the program in a folder.
inline std::vector<std::string> line(const Folder& folder, std::vector<std::string> arguments)
{
  std::vector<std::string> command{"/usr/bin/env", "-C", folder.path().string(), MASTIC_COMMAND};
  command.insert(command.end(), arguments.begin(), arguments.end());
  return command;
}

/// Runs the program to its end; output and errors are in one text.
inline apps::Finished mastic(const Folder& folder, const std::vector<std::string>& arguments)
{
  return apps::run_to_end(line(folder, arguments));
}

/// The same under a command of the shell that ends in "$@".
inline apps::Finished mastic_in_shell(const Folder& folder, const std::string& script,
                                      const std::vector<std::string>& arguments)
{
  std::vector<std::string> command{"/bin/sh", "-c", script, "sh"};
  for (const std::string& word : line(folder, arguments))
    command.push_back(word);
  return apps::run_to_end(command);
}

/// "--set" before each setting.
inline std::vector<std::string> with(std::vector<std::string> arguments,
                                     const std::vector<std::string>& settings)
{
  for (const std::string& each : settings)
    arguments.insert(arguments.end(), {"--set", each});
  return arguments;
}

inline bool contains(const std::string& text, const std::string& part)
{
  return text.find(part) != std::string::npos;
}

} // namespace command
