#include "apps/csv_table.h"
#include "apps/files.h"
#include "apps/specimen.h"
#include "dem/storage.h"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

namespace apps {

namespace {

constexpr const char* recipe_attribute = "recipe";

std::vector<dem::Support> supports(const CsvTable& table)
{
  std::vector<dem::Support> result;
  const std::size_t column = *table.find("held");
  for (std::size_t row = 0; row < table.n_rows(); ++row) {
    const std::string& cell = table.cell(row, column);
    if (cell == "free")
      result.push_back(dem::Support::free);
    else if (cell == "bottom")
      result.push_back(dem::Support::bottom);
    else if (cell == "top")
      result.push_back(dem::Support::top);
    else
      throw std::invalid_argument(fmt::format("{}: column 'held': '{}' is not one of: free | "
                                              "bottom | top",
                                              table.place(row), cell));
  }
  return result;
}

std::vector<dem::ParticleLoad> particle_loads(const CsvTable& table)
{
  std::vector<dem::ParticleLoad> loads;
  const auto fx = table.numbers_or("fx", "N", 0), fy = table.numbers_or("fy", "N", 0),
             fz = table.numbers_or("fz", "N", 0), mx = table.numbers_or("mx", "N m", 0),
             my = table.numbers_or("my", "N m", 0), mz = table.numbers_or("mz", "N m", 0);
  for (std::size_t i = 0; i < table.n_rows(); ++i) {
    const dem::Vec3 force(fx[i], fy[i], fz[i]), moment(mx[i], my[i], mz[i]);
    if (!force.isZero(0) || !moment.isZero(0))
      loads.push_back({dem::Index(i), force, moment});
  }
  return loads;
}

void check_radius(double radius, const std::string& place, bool accept_unusual)
{
  if (!(radius > 0))
    throw std::invalid_argument(
        fmt::format("{}: the radius must be > 0, found {:g} m", place, radius));
  if (!accept_unusual && (radius < 1e-6 || radius > 1))
    throw std::invalid_argument(
        fmt::format("{}: a radius of {:g} m is outside 1e-6 to 1 m; if that "
                    "is meant, set Accept unusual values = true",
                    place, radius));
}

/// Spheres that overlap by more than a tenth of the smaller radius come from a mistake.
void refuse_deep_overlaps(const dem::Particles& particles, const CsvTable& table)
{
  const auto pairs = dem::contacts_within(particles, -0.1).pairs;
  if (pairs.empty())
    return;
  const auto [a, b] = pairs.front();
  throw std::invalid_argument(fmt::format(
      "{}: the sphere overlaps the one at {} by more than a tenth of the smaller radius{}; "
      "if that is meant, set Accept unusual values = true",
      table.place(b), table.place(a),
      pairs.size() == 1 ? "" : fmt::format("; there are {} such pairs", pairs.size())));
}

Packing packing_from_csv(const LoadedScene& loaded, const std::filesystem::path& file)
{
  const CsvTable table(file, *loaded.units);
  if (table.n_rows() == 0)
    throw std::invalid_argument(fmt::format("{}: there are no particles in it", file.string()));
  table.allow_only({"x", "y", "z", "r", "class", "held", "fx", "fy", "fz", "mx", "my", "mz"});
  Packing packing;
  const auto x = table.numbers("x", "m"), y = table.numbers("y", "m"), z = table.numbers("z", "m");
  packing.particles.radius = table.numbers("r", "m");
  for (std::size_t i = 0; i < table.n_rows(); ++i) {
    packing.particles.centre.emplace_back(x[i], y[i], z[i]);
    check_radius(packing.particles.radius[i], table.place(i), loaded.scene->accept_unusual);
  }
  packing.particles.density = loaded.scene->specimen.density;
  if (table.find("class"))
    for (const long c : table.integers("class"))
      packing.particles.material_class.push_back(int(c));
  else
    packing.particles.material_class.assign(table.n_rows(), 0);
  if (table.find("held"))
    packing.support = supports(table);
  packing.loads = particle_loads(table);
  packing.platens = dem::packing_extent(packing.particles);
  packing.origin = file.string();
  if (!loaded.scene->accept_unusual)
    refuse_deep_overlaps(packing.particles, table);
  return packing;
}

} // namespace

void write_packing(const std::filesystem::path& file, const Packing& packing,
                   const std::string& recipe)
{
  if (file.has_parent_path())
    make_folder(file.parent_path());
  dem::Hdf5File hdf5 = dem::Hdf5File::create(file);
  dem::write_particles(hdf5, "particles", packing.particles);
  hdf5.set_attribute("", "kind", std::string("packing"));
  hdf5.set_attribute("", "storage_version", dem::storage_version);
  hdf5.set_attribute("", recipe_attribute, recipe);
  hdf5.set_attribute("", "origin", packing.origin);
  hdf5.set_attribute("particles", "lower_platen_m", packing.platens.low);
  hdf5.set_attribute("particles", "upper_platen_m", packing.platens.high);
  hdf5.set_attribute("particles", "diameter_m", packing.diameter.value_or(0));
  hdf5.publish();
}

Packing read_packing(const std::filesystem::path& file, const std::optional<std::string>& recipe)
{
  const dem::Hdf5File hdf5 = open_stored(file, "packing");
  try {
    if (recipe && hdf5.text_attribute("", recipe_attribute) != *recipe)
      throw std::invalid_argument(fmt::format("{}: this packing was made from other keys of the "
                                              "section Specimen than the scene has; make it anew "
                                              "with 'mastic pack', or name it as File",
                                              file.string()));
    return {dem::read_particles(hdf5, "particles"),
            std::nullopt,
            {},
            {hdf5.number_attribute("particles", "lower_platen_m"),
             hdf5.number_attribute("particles", "upper_platen_m")},
            hdf5.text_attribute("", "origin"),
            hdf5.number_attribute("particles", "diameter_m")};
  } catch (const std::runtime_error& damage) {
    throw std::invalid_argument(damage.what());
  }
}

std::string files_fingerprint(const LoadedScene& loaded)
{
  std::uint64_t hash = 0xcbf29ce484222325; // FNV-1a
  const Scene::Specimen& v = loaded.scene->specimen;
  if (v.source == SpecimenSource::file)
    for (const std::string& name : {v.file, v.bond_file})
      if (!name.empty())
        for (const char c : read_text_file(loaded.folder / name))
          hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  return fmt::format("{:016x}", hash);
}

Packing make_packing(const LoadedScene& loaded)
{
  const Scene::Specimen& v = loaded.scene->specimen;
  if (v.source == SpecimenSource::generate) {
    const dem::PackingRequest request = packing_request(*loaded.scene);
    return {dem::grow_packing(request, std::uint64_t(v.seed)),
            std::nullopt,
            {},
            {0, request.container.height},
            fmt::format("generated, seed {}", v.seed),
            v.diameter};
  }
  const std::filesystem::path file = loaded.folder / v.file;
  if (file.extension() == ".csv")
    return packing_from_csv(loaded, file);
  if (file.extension() == ".h5")
    return read_packing(file, std::nullopt);
  throw std::invalid_argument(
      fmt::format("{}: packings are read from .csv and .h5", file.string()));
}

} // namespace apps
