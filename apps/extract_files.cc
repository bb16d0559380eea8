#include "apps/extract_files.h"

#include "apps/files.h"
#include "apps/plot.h"
#include "apps/provenance.h"
#include "fem/mandel.h"
#include "fem/series_fit.h"
#include "fem/symmetry.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace apps {

namespace {

constexpr double degree = std::numbers::pi / 180, ice = 273.15;

fem::EngineeringConstants<double> isotropic_at(const fem::ComplianceLaw& law, double t)
{
  return fem::engineering_constants(fem::nearest(fem::compliance(law, t), fem::Symmetry{}));
}

std::vector<Column> realisation_columns(const Extraction& e)
{
  std::vector<Column> columns{{"spheres", "1", {}},        {"seed", "1", {}},
                              {"bonds", "1", {}},          {"edge_over_largest_diameter", "1", {}},
                              {"volume_mm3", "mm3", {}},   {"solid_fraction", "1", {}},
                              {"hill_mandel_gap", "1", {}}};
  for (const dem::BoundaryCondition each : all_conditions) {
    std::string name = name_of(each);
    std::ranges::replace(name, ' ', '_');
    columns.push_back({name + "_young_MPa", "MPa", {}});
    columns.push_back({name + "_poisson", "1", {}});
  }
  for (const Realisation& r : e.realisations) {
    const double values[] = {double(r.n_particles), double(r.seed), double(r.n_bonds),
                             r.size_ratio,          1e9 * r.volume, r.solid_fraction,
                             r.hill_mandel};
    for (std::size_t c = 0; c < std::size(values); ++c)
      columns[c].values.push_back(values[c]);
    for (std::size_t k = 0; k < all_conditions.size(); ++k) {
      double young = NAN, poisson = NAN;
      if (r.stiffness[k]) {
        const auto constants = fem::engineering_constants(
            fem::nearest(dem::compliance(*r.stiffness[k]), fem::Symmetry{}));
        young = 1e-6 * constants.young[0];
        poisson = constants.poisson(0, 1);
      }
      columns[std::size(values) + 2 * k].values.push_back(young);
      columns[std::size(values) + 2 * k + 1].values.push_back(poisson);
    }
  }
  return columns;
}

/// S(t) of the law that is written, all components, and the constants of the nearest isotropic one.
std::vector<Column> compliance_columns(const Scene& scene, const Extraction& e)
{
  std::vector<Column> columns{{"time_s", "s", {}},
                              {"uniaxial_compliance_isotropic_per_GPa", "1/GPa", {}},
                              {"uniaxial_compliance_1_per_GPa", "1/GPa", {}},
                              {"uniaxial_compliance_2_per_GPa", "1/GPa", {}},
                              {"uniaxial_compliance_3_per_GPa", "1/GPa", {}},
                              {"poisson_ratio", "1", {}}};
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j <= i; ++j)
      columns.push_back({fmt::format("S{}{}_mandel_per_GPa", i + 1, j + 1), "1/GPa", {}});
  const VolumeElementInput& v = scene.element;
  std::vector<double> times{0};
  for (const double t : fem::retardation_grid(v.first_time, v.last_time, int(v.n_times)))
    times.push_back(t);
  for (const double t : times) {
    const dem::Mat6 s = fem::compliance(e.record.law, t);
    const auto constants = isotropic_at(e.record.law, t);
    std::vector<double> row{t,
                            1e9 / constants.young[0],
                            1e9 * s(0, 0),
                            1e9 * s(1, 1),
                            1e9 * s(2, 2),
                            constants.poisson(0, 1)};
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j <= i; ++j)
        row.push_back(1e9 * s(i, j));
    for (std::size_t c = 0; c < row.size(); ++c)
      columns[c].values.push_back(row[c]);
  }
  return columns;
}

/// E* of the nearest isotropic law over temperature and frequency.
std::vector<Column> modulus_columns(const Scene& scene, const Extraction& e)
{
  std::vector<Column> columns{
      {"temperature_degC", "degC", {}},   {"frequency_Hz", "Hz", {}},
      {"shift_factor", "1", {}},          {"reduced_frequency_Hz", "Hz", {}},
      {"dynamic_modulus_MPa", "MPa", {}}, {"phase_angle_deg", "deg", {}},
      {"storage_modulus_MPa", "MPa", {}}, {"loss_modulus_MPa", "MPa", {}}};
  std::vector<double> temperatures = scene.element.temperatures;
  if (temperatures.empty())
    temperatures.push_back(scene.temperature.temperature);
  const fem::ComplianceLaw isotropic = fem::nearest(e.record.law, fem::Symmetry{});
  for (const double temperature : temperatures)
    for (const double f : scene.output.frequencies) {
      const double shift = fem::shift_factor(e.record.shift, temperature);
      const auto constants = fem::engineering_constants(
          fem::complex_compliance(isotropic, 2 * std::numbers::pi * f * shift));
      const std::complex<double> modulus = 1e-6 * constants.young[0];
      const double row[] = {temperature - ice,
                            f,
                            shift,
                            f * shift,
                            std::abs(modulus),
                            std::arg(modulus) / degree,
                            modulus.real(),
                            modulus.imag()};
      for (std::size_t c = 0; c < columns.size(); ++c)
        columns[c].values.push_back(row[c]);
    }
  return columns;
}

void write_provenance(dem::Hdf5File& file, const LoadedScene& scene)
{
  write_origin(file, scene, "extraction");
  file.write_text("scene/as_typed", scene.text);
  file.write_text("scene/resolved", scene.schema->print(false));
}

} // namespace

void write_extraction(const LoadedScene& scene, const Extraction& e,
                      const std::filesystem::path& folder)
{
  make_folder(folder);
  const std::vector<std::pair<std::string, std::vector<Column>>> tables{
      {"realisations", realisation_columns(e)},
      {"compliance", compliance_columns(*scene.scene, e)},
      {"complex_modulus", modulus_columns(*scene.scene, e)}};
  dem::Hdf5File file = dem::Hdf5File::create(folder / "extraction.h5");
  write_provenance(file, scene);
  file.write_text("law", fem::law_text(e.record));
  for (const auto& [name, columns] : tables) {
    write_columns(file, name, columns);
    write_text_file(folder / (name + ".csv"), csv(columns));
  }
  file.publish();
  write_text_file(folder / (scene.name + ".law"), fem::law_text(e.record));
  fmt::print("  law in {}\n  tables in {}\n", (folder / (scene.name + ".law")).string(),
             folder.string());
  if (scene.scene->output.plots)
    for (const std::string& figure : make_extraction_figures(folder))
      fmt::print("  figure {}\n", figure);
}

} // namespace apps
