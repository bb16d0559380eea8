#include "apps/files.h"

#include "dem/storage.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <unistd.h>

#include <stdexcept>

namespace apps {

dem::Hdf5File open_stored(const std::filesystem::path& file, const std::string& kind)
{
  try {
    dem::Hdf5File stored = dem::Hdf5File::open(file);
    if (!stored.is_complete())
      throw std::runtime_error(file.string() +
                               ": this was not written by mastic, or it was cut off");
    const std::string found = stored.text_attribute("", "kind");
    if (!kind.empty() && found != kind)
      throw std::runtime_error(
          fmt::format("{}: this is a {}, not a {}", file.string(), found, kind));
    if (stored.number_attribute("", "storage_version") > dem::storage_version)
      throw std::runtime_error(file.string() + ": the file was written by a newer version");
    return stored;
  } catch (const std::runtime_error& problem) {
    throw std::invalid_argument(problem.what());
  }
}

void require_writable(const std::filesystem::path& folder)
{
  std::error_code ignored;
  std::filesystem::path there = absolute_folder(folder);
  while (!std::filesystem::exists(there, ignored))
    there = there.parent_path();
  if (!std::filesystem::is_directory(there, ignored))
    throw std::invalid_argument(fmt::format("{}: results go into a folder, but {} is a file",
                                            folder.string(), there.string()));
  if (::access(there.c_str(), W_OK | X_OK) != 0)
    throw std::invalid_argument(fmt::format("{}: results cannot be written there: you may not "
                                            "write in {}",
                                            folder.string(), there.string()));
}

std::filesystem::path absolute_folder(const std::filesystem::path& folder)
{
  return folder.empty() ? std::filesystem::current_path() : std::filesystem::absolute(folder);
}

void make_folder(const std::filesystem::path& folder)
{
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  if (failed)
    throw std::runtime_error(
        fmt::format("the folder {} cannot be made: {}", folder.string(), failed.message()));
}

void write_text_file(const std::filesystem::path& file, const std::string& text)
{
  if (file.has_parent_path())
    make_folder(file.parent_path());
  const std::string part = file.string() + ".part";
  const auto fail = [&] {
    std::error_code ignored;
    std::filesystem::remove(part, ignored);
    throw std::runtime_error(fmt::format("{} cannot be written; is there room, and may you write "
                                         "there?",
                                         file.string()));
  };
  const int descriptor = ::open(part.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
  if (descriptor < 0)
    fail();
  std::size_t done = 0;
  while (done < text.size()) {
    const ssize_t n = ::write(descriptor, text.data() + done, text.size() - done);
    if (n <= 0) {
      ::close(descriptor);
      fail();
    }
    done += std::size_t(n);
  }
  const bool synced = ::fsync(descriptor) == 0;
  if (::close(descriptor) != 0 || !synced)
    fail();
  std::error_code failed;
  std::filesystem::rename(part, file, failed);
  if (failed)
    fail();
}

std::filesystem::path own_executable()
{
  return std::filesystem::read_symlink("/proc/self/exe");
}

std::filesystem::path existing(const std::string& name, const char* what)
{
  if (!std::filesystem::exists(name))
    throw std::invalid_argument(fmt::format("{}: there is no such {}", name, what));
  return name;
}

std::filesystem::path share_folder()
{
  const std::filesystem::path installed = own_executable().parent_path() / "../share/mastic";
  for (const std::filesystem::path& folder :
       {installed, std::filesystem::path(MASTIC_SOURCE_SHARE)})
    if (std::filesystem::exists(folder / "plot.py"))
      return folder.lexically_normal();
  throw std::runtime_error(fmt::format("the plotting script plot.py is neither in {} nor in {}",
                                       installed.lexically_normal().string(), MASTIC_SOURCE_SHARE));
}

} // namespace apps
