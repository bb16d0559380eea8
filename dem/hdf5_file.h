#pragma once
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace dem {

/// An HDF5 file with groups, arrays and attributes, as far as this program needs them.
///
/// Arrays carry their unit as an attribute and a checksum; metadata are checksummed as well. Names
/// are paths ("snapshots/0001/force"); groups are made on the way. All members throw
/// std::runtime_error with the file and the object at fault.
class Hdf5File {
public:
  /// A new file under a temporary name next to `path`. `publish` gives it its name.
  static Hdf5File create(const std::filesystem::path& path);

  /// An existing file, to read.
  static Hdf5File open(const std::filesystem::path& path);

  ~Hdf5File();
  Hdf5File(Hdf5File&& other) noexcept;
  Hdf5File& operator=(Hdf5File&&) = delete;

  /// Marks the file as complete, flushes it to the disk and renames it: after that it is either
  /// whole or not there. The file is closed.
  void publish();

  /// True if a file was published, not cut off.
  bool is_complete() const;

  /// Arrays of doubles, integers or bytes; `columns` > 1 makes rows of that length.
  void write(const std::string& name, std::span<const double> values, const std::string& unit,
             int columns = 1);
  void write(const std::string& name, std::span<const std::int32_t> values, int columns = 1);
  void write(const std::string& name, std::span<const std::int64_t> values, int columns = 1);
  void write(const std::string& name, std::span<const std::uint8_t> values, int columns = 1);
  void write_text(const std::string& name, const std::string& text);

  std::vector<double> read_doubles(const std::string& name) const;
  std::vector<std::int32_t> read_integers(const std::string& name) const;
  std::vector<std::int64_t> read_long_integers(const std::string& name) const;
  std::vector<std::uint8_t> read_bytes(const std::string& name) const;
  std::string read_text(const std::string& name) const;

  /// Attributes of a group or array ("" is the file).
  void set_attribute(const std::string& object, const std::string& name, const std::string& text);
  void set_attribute(const std::string& object, const std::string& name, double value);
  std::string text_attribute(const std::string& object, const std::string& name) const;
  double number_attribute(const std::string& object, const std::string& name) const;

  bool has(const std::string& name) const;

  /// Names of the members of a group, sorted.
  std::vector<std::string> members(const std::string& group) const;

private:
  Hdf5File(std::int64_t id, std::filesystem::path path, bool writing);
  [[noreturn]] void fail(const std::string& what, const std::string& object) const;

  std::int64_t id_;
  std::filesystem::path path_;
  bool writing_;
};

} // namespace dem
