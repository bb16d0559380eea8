#include "dem/hdf5_file.h"

#include <fmt/format.h>
#include <hdf5.h>

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace dem {

namespace {

constexpr const char* complete_mark = "complete";

/// Closes an HDF5 object at the end of its scope.
struct Handle {
  hid_t id;
  herr_t (*close)(hid_t);
  Handle(hid_t object, herr_t (*closer)(hid_t)) : id(object), close(closer) {}
  ~Handle()
  {
    if (id >= 0)
      close(id);
  }
  Handle(const Handle&) = delete;
  explicit operator bool() const { return id >= 0; }
};

/// HDF5 prints a stack of errors by default; ours are exceptions.
struct Quiet {
  H5E_auto2_t function = nullptr;
  void* data = nullptr;
  Quiet()
  {
    H5Eget_auto2(H5E_DEFAULT, &function, &data);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  ~Quiet() { H5Eset_auto2(H5E_DEFAULT, function, data); }
};

std::filesystem::path temporary_name(const std::filesystem::path& path)
{
  return path.string() + ".part";
}

template <typename T>
hid_t memory_type()
{
  if constexpr (std::is_same_v<T, double>)
    return H5T_NATIVE_DOUBLE;
  else if constexpr (std::is_same_v<T, std::int32_t>)
    return H5T_NATIVE_INT32;
  else if constexpr (std::is_same_v<T, std::int64_t>)
    return H5T_NATIVE_INT64;
  else
    return H5T_NATIVE_UINT8;
}

/// \return false on failure
template <typename T>
bool write_array(hid_t file, const std::string& name, std::span<const T> values, int columns)
{
  const Quiet quiet;
  const hsize_t dims[2] = {values.size() / hsize_t(columns), hsize_t(columns)};
  const Handle space(H5Screate_simple(columns > 1 ? 2 : 1, dims, nullptr), H5Sclose);
  const Handle links(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
  H5Pset_create_intermediate_group(links.id, 1);
  const Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  if (!values.empty()) { // checksums need chunks
    const hsize_t rows = std::max<hsize_t>(1, std::min<hsize_t>(dims[0], (1u << 20) / columns));
    const hsize_t chunk[2] = {rows, hsize_t(columns)};
    H5Pset_chunk(properties.id, columns > 1 ? 2 : 1, chunk);
    H5Pset_fletcher32(properties.id);
  }
  const Handle set(H5Dcreate2(file, name.c_str(), memory_type<T>(), space.id, links.id,
                              properties.id, H5P_DEFAULT),
                   H5Dclose);
  return set && (values.empty() || H5Dwrite(set.id, memory_type<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT,
                                            values.data()) >= 0);
}

/// \return false on failure
template <typename T>
bool read_array(hid_t file, const std::string& name, std::vector<T>& values)
{
  const Quiet quiet;
  const Handle set(H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose);
  if (!set)
    return false;
  const Handle space(H5Dget_space(set.id), H5Sclose);
  values.resize(std::size_t(H5Sget_simple_extent_npoints(space.id)));
  return values.empty() ||
         H5Dread(set.id, memory_type<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) >= 0;
}

void sync_to_disk(const std::filesystem::path& path)
{
  const int descriptor = ::open(path.c_str(), O_RDONLY);
  if (descriptor >= 0) {
    ::fsync(descriptor);
    ::close(descriptor);
  }
}

} // namespace

Hdf5File::Hdf5File(std::int64_t id, std::filesystem::path path, bool writing)
    : id_(id), path_(std::move(path)), writing_(writing)
{
}

Hdf5File::Hdf5File(Hdf5File&& other) noexcept
    : id_(std::exchange(other.id_, -1)), path_(std::move(other.path_)), writing_(other.writing_)
{
}

Hdf5File::~Hdf5File()
{
  if (id_ < 0)
    return;
  const Quiet quiet;
  H5Fclose(id_);
  std::error_code ignored; // an unpublished file is thrown away
  if (writing_)
    std::filesystem::remove(temporary_name(path_), ignored);
}

void Hdf5File::fail(const std::string& what, const std::string& object) const
{
  throw std::runtime_error(fmt::format("{}: {}{}", path_.string(), what,
                                       object.empty() ? "" : fmt::format(" '{}'", object)));
}

Hdf5File Hdf5File::create(const std::filesystem::path& path)
{
  const Quiet quiet;
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_libver_bounds(access.id, H5F_LIBVER_LATEST,
                       H5F_LIBVER_LATEST); // all metadata with checksums
  const hid_t id = H5Fcreate(temporary_name(path).c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.id);
  Hdf5File file(id, path, true);
  if (id < 0)
    file.fail("the file cannot be written; is there room, and may you write there?", "");
  return file;
}

Hdf5File Hdf5File::open(const std::filesystem::path& path)
{
  const Quiet quiet;
  if (!std::filesystem::exists(path))
    throw std::runtime_error(fmt::format("{}: there is no such file", path.string()));
  const hid_t id = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  Hdf5File file(id, path, false);
  if (id < 0)
    file.fail("this is not an HDF5 file, or it is damaged", "");
  return file;
}

void Hdf5File::publish()
{
  set_attribute("", complete_mark, 1);
  const Quiet quiet;
  const bool flushed = H5Fflush(id_, H5F_SCOPE_GLOBAL) >= 0;
  const bool closed = H5Fclose(std::exchange(id_, -1)) >= 0;
  if (!flushed || !closed) {
    std::error_code ignored;
    std::filesystem::remove(temporary_name(path_), ignored);
    fail("the file cannot be written; is the disk full?", "");
  }
  sync_to_disk(temporary_name(path_));
  std::filesystem::rename(temporary_name(path_), path_);
}

bool Hdf5File::is_complete() const
{
  const Quiet quiet;
  return H5Aexists(id_, complete_mark) > 0;
}

void Hdf5File::write(const std::string& name, std::span<const double> values,
                     const std::string& unit, int columns)
{
  if (!write_array(id_, name, values, columns))
    fail("cannot write", name);
  set_attribute(name, "unit", unit);
}

void Hdf5File::write(const std::string& name, std::span<const std::int32_t> values, int columns)
{
  if (!write_array(id_, name, values, columns))
    fail("cannot write", name);
}

void Hdf5File::write(const std::string& name, std::span<const std::int64_t> values, int columns)
{
  if (!write_array(id_, name, values, columns))
    fail("cannot write", name);
}

void Hdf5File::write(const std::string& name, std::span<const std::uint8_t> values, int columns)
{
  if (!write_array(id_, name, values, columns))
    fail("cannot write", name);
}

void Hdf5File::write_text(const std::string& name, const std::string& text)
{
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(text.data());
  write(name, std::span(bytes, text.size()));
}

std::vector<double> Hdf5File::read_doubles(const std::string& name) const
{
  std::vector<double> values;
  if (!read_array(id_, name, values))
    fail("cannot read", name);
  return values;
}

std::vector<std::int32_t> Hdf5File::read_integers(const std::string& name) const
{
  std::vector<std::int32_t> values;
  if (!read_array(id_, name, values))
    fail("cannot read", name);
  return values;
}

std::vector<std::int64_t> Hdf5File::read_long_integers(const std::string& name) const
{
  std::vector<std::int64_t> values;
  if (!read_array(id_, name, values))
    fail("cannot read", name);
  return values;
}

std::vector<std::uint8_t> Hdf5File::read_bytes(const std::string& name) const
{
  std::vector<std::uint8_t> values;
  if (!read_array(id_, name, values))
    fail("cannot read", name);
  return values;
}

std::string Hdf5File::read_text(const std::string& name) const
{
  const std::vector<std::uint8_t> bytes = read_bytes(name);
  return {bytes.begin(), bytes.end()};
}

void Hdf5File::set_attribute(const std::string& object, const std::string& name,
                             const std::string& text)
{
  const Quiet quiet;
  const Handle target(H5Oopen(id_, object.empty() ? "/" : object.c_str(), H5P_DEFAULT), H5Oclose);
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.id, std::max<std::size_t>(1, text.size()));
  H5Tset_cset(type.id, H5T_CSET_UTF8);
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle attribute(
      H5Acreate2(target.id, name.c_str(), type.id, space.id, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  const std::string padded = text.empty() ? std::string(1, '\0') : text;
  if (!attribute || H5Awrite(attribute.id, type.id, padded.data()) < 0)
    fail("cannot write attribute", object + "/" + name);
}

void Hdf5File::set_attribute(const std::string& object, const std::string& name, double value)
{
  const Quiet quiet;
  const Handle target(H5Oopen(id_, object.empty() ? "/" : object.c_str(), H5P_DEFAULT), H5Oclose);
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle attribute(
      H5Acreate2(target.id, name.c_str(), H5T_NATIVE_DOUBLE, space.id, H5P_DEFAULT, H5P_DEFAULT),
      H5Aclose);
  if (!attribute || H5Awrite(attribute.id, H5T_NATIVE_DOUBLE, &value) < 0)
    fail("cannot write attribute", object + "/" + name);
}

std::string Hdf5File::text_attribute(const std::string& object, const std::string& name) const
{
  const Quiet quiet;
  const Handle attribute(H5Aopen_by_name(id_, object.empty() ? "/" : object.c_str(), name.c_str(),
                                         H5P_DEFAULT, H5P_DEFAULT),
                         H5Aclose);
  if (!attribute)
    fail("cannot read attribute", object + "/" + name);
  const Handle type(H5Aget_type(attribute.id), H5Tclose);
  std::string text(H5Tget_size(type.id), '\0');
  if (H5Aread(attribute.id, type.id, text.data()) < 0)
    fail("cannot read attribute", object + "/" + name);
  text.resize(std::min(text.find('\0'), text.size()));
  return text;
}

double Hdf5File::number_attribute(const std::string& object, const std::string& name) const
{
  const Quiet quiet;
  const Handle attribute(H5Aopen_by_name(id_, object.empty() ? "/" : object.c_str(), name.c_str(),
                                         H5P_DEFAULT, H5P_DEFAULT),
                         H5Aclose);
  double value = 0;
  if (!attribute || H5Aread(attribute.id, H5T_NATIVE_DOUBLE, &value) < 0)
    fail("cannot read attribute", object + "/" + name);
  return value;
}

bool Hdf5File::has(const std::string& name) const
{
  const Quiet quiet;
  std::string part;
  for (std::size_t end = 0; end != std::string::npos;) { // every group on the way must exist
    end = name.find('/', end == 0 ? 0 : end + 1);
    part = name.substr(0, end);
    if (H5Lexists(id_, part.c_str(), H5P_DEFAULT) <= 0)
      return false;
  }
  return true;
}

std::vector<std::string> Hdf5File::members(const std::string& group) const
{
  const Quiet quiet;
  std::vector<std::string> names;
  if (!group.empty() && !has(group))
    return names;
  const Handle target(H5Gopen2(id_, group.empty() ? "/" : group.c_str(), H5P_DEFAULT), H5Gclose);
  const auto collect = [](hid_t, const char* name, const H5L_info_t*, void* list) -> herr_t {
    static_cast<std::vector<std::string>*>(list)->emplace_back(name);
    return 0;
  };
  if (!target || H5Literate(target.id, H5_INDEX_NAME, H5_ITER_INC, nullptr, collect, &names) < 0)
    fail("cannot list", group);
  return names;
}

} // namespace dem
