#include "apps/provenance.h"

#include "apps/machine.h"
#include "dem/storage.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <chrono>
#include <numbers>

namespace apps {

void write_origin(dem::Hdf5File& file, const LoadedScene& scene, const std::string& kind)
{
  file.set_attribute("", "kind", kind);
  file.set_attribute("", "program", std::string("mastic " MASTIC_VERSION));
  file.set_attribute("", "revision", std::string(MASTIC_REVISION));
  file.set_attribute("", "compiler", std::string(MASTIC_COMPILER));
  file.set_attribute("", "storage_version", dem::storage_version);
  file.set_attribute(
      "", "written_utc",
      fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::chrono::system_clock::now())));
  file.set_attribute("", "name", scene.name);
  file.set_attribute("", "title", scene.scene->title);
  file.set_attribute("", "machine", machine_name());
}

std::vector<Column> modulus_columns(const std::vector<double>& frequencies,
                                    const std::function<std::complex<double>(double)>& modulus)
{
  std::vector<Column> columns{{"frequency_Hz", "Hz", {}},
                              {"complex_modulus_MPa", "MPa", {}},
                              {"phase_angle_degrees", "degree", {}},
                              {"storage_modulus_MPa", "MPa", {}},
                              {"loss_modulus_MPa", "MPa", {}}};
  for (const double f : frequencies) {
    const std::complex<double> e = modulus(2 * std::numbers::pi * f);
    const double row[] = {f, std::abs(e) / 1e6, std::arg(e) * 180 / std::numbers::pi,
                          e.real() / 1e6, e.imag() / 1e6};
    for (std::size_t k = 0; k < columns.size(); ++k)
      columns[k].values.push_back(row[k]);
  }
  return columns;
}

} // namespace apps
