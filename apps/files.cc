#include "apps/files.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <unistd.h>

#include <stdexcept>

namespace apps {

void write_text_file(const std::filesystem::path& file, const std::string& text)
{
  if (file.has_parent_path())
    std::filesystem::create_directories(file.parent_path());
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
  std::filesystem::rename(part, file);
}

std::filesystem::path own_executable()
{
  return std::filesystem::read_symlink("/proc/self/exe");
}

std::filesystem::path share_folder()
{
  const std::filesystem::path installed = own_executable().parent_path() / "../share/mastic";
  for (const std::filesystem::path& folder : {installed, std::filesystem::path(MASTIC_SOURCE_SHARE)})
    if (std::filesystem::exists(folder / "plot.py"))
      return folder.lexically_normal();
  throw std::runtime_error(fmt::format("the plotting script plot.py is neither in {} nor in {}",
                                       installed.lexically_normal().string(), MASTIC_SOURCE_SHARE));
}

} // namespace apps
