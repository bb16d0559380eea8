#include "apps/calibrate.h"

#include "apps/element_realisations.h"
#include "apps/files.h"
#include "apps/fit_data.h"
#include "apps/fit_report.h"
#include "apps/plot.h"
#include "apps/quantity.h"
#include "apps/run_record.h"
#include "apps/specimen.h"
#include "apps/text.h"
#include "coupling/calibration.h"
#include "dem/linear.h"
#include "fem/curve_fit.h"
#include "fem/symmetry.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace apps {

namespace {

constexpr int most_terms = 60;

constexpr int most_branches = 6;
constexpr double degree = std::numbers::pi / 180;

/// A calibrated law and what it gives.
struct Calibrated {
  int n_branches; ///< asked for; those off their bound may be fewer
  fem::CurveFit fit;
  dem::CreepLaw law;
};

/// Creep compliance at t = 0 [1/Pa] of the specimen, over its platens.
double specimen_compliance(const LoadedScene& scene, const Packing& packing)
{
  dem::Assembly assembly = make_specimen(scene, packing).assembly;
  assembly.strengths.reset();
  return dem::creep_compliance(dem::make_linear_model(assembly), 0);
}

/// That of the material: of the mean compliance of the volume elements of the largest size, nearest
/// isotropic tensor. Nothing if the user ended it.
std::optional<double> element_compliance(const LoadedScene& scene, PackingStore& store,
                                         const RunOptions& options)
{
  std::vector<RealisationTask> tasks = realisation_tasks(*scene.scene);
  std::erase_if(tasks, [n = tasks.front().n_particles](const RealisationTask& task) {
    return task.n_particles != n;
  });
  const auto wanted =
      std::ranges::find(all_conditions, scene.scene->element.condition) - all_conditions.begin();
  dem::Mat6 mean = dem::Mat6::Zero();
  for (const std::optional<Realisation>& each : realise_all(scene, tasks, store, options)) {
    if (!each)
      return std::nullopt;
    mean += dem::compliance(*each->stiffness[std::size_t(wanted)]) / double(tasks.size());
  }
  return 1 / fem::engineering_constants(fem::nearest(mean, fem::Symmetry{})).young[0];
}

/// The one law of the bonds of a scene.
dem::CreepLaw only_law(const Scene& scene)
{
  if (!scene.more_bonds.empty())
    throw std::invalid_argument("the scene has several bond laws: one measured curve does not "
                                "determine them");
  return bond_laws(scene, 1).front().creep;
}

/// Puts a law into the scene.
void set_law(Scene& scene, const dem::CreepLaw& law)
{
  scene.bonds.maxwell_stiffness = law.maxwell_stiffness;
  scene.bonds.maxwell_viscosity = law.maxwell_viscosity;
  scene.bonds.kelvin_stiffness.clear();
  scene.bonds.kelvin_viscosity.clear();
  for (const dem::KelvinBranch& branch : law.branches) {
    scene.bonds.kelvin_stiffness.push_back(branch.stiffness);
    scene.bonds.kelvin_viscosity.push_back(branch.viscosity);
  }
}

Calibrated calibrated(const fem::Measurements& data, const fem::CurveFitOptions& common, int n,
                      double factor)
{
  fem::CurveFitOptions options = common;
  options.n_terms = n;
  Calibrated result{n, fem::fit_curve(data, options), {}};
  result.law = coupling::calibrated_law(fem::creep_series(result.fit).law, factor);
  return result;
}

std::string joined(const std::vector<dem::KelvinBranch>& branches, double dem::KelvinBranch::*what,
                   const char* unit)
{
  std::string text;
  for (const dem::KelvinBranch& branch : branches)
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", shortest(branch.*what), unit);
  return text;
}

/// The law as a section of a scene.
std::string bonds_section(const Calibrated& best, const Scene& scene, const std::string& source)
{
  return fmt::format(
      "# Bond law calibrated to {}, for the packing of this scene:\n"
      "# rms error of the measured curve {:.3g} %, reduced times {:g} s to {:g} s at {:g} degC.\n"
      "subsection Bonds\n"
      "  set Maxwell stiffness     = {} N/m\n"
      "  set Maxwell viscosity     = {}\n"
      "  set Kelvin stiffness      = {}\n"
      "  set Kelvin viscosity      = {}\n"
      "  set Normal to shear ratio = {}\n"
      "  set Radius multiplier     = {}\n"
      "end\n"
      "subsection Volume element # the law is known from here to there\n"
      "  set First time = {} s\n"
      "  set Last time  = {} s\n"
      "end\n",
      source, 100 * best.fit.relative_rms, best.fit.valid_time.first, best.fit.valid_time.last,
      best.fit.reference_temperature - 273.15, shortest(best.law.maxwell_stiffness),
      best.law.maxwell_viscosity ? shortest(*best.law.maxwell_viscosity) + " N s/m" : "none",
      joined(best.law.branches, &dem::KelvinBranch::stiffness, "N/m"),
      joined(best.law.branches, &dem::KelvinBranch::viscosity, "N s/m"),
      shortest(scene.bonds.normal_to_shear), shortest(scene.bonds.radius_multiplier),
      shortest(best.fit.valid_time.first), shortest(best.fit.valid_time.last));
}

/// Measured curve, and that of the packing with the calibrated law and the elastic compliance
/// [1/Pa] that was solved for anew.
std::vector<Column> check_columns(const fem::Measurements& reduced, const Calibrated& best,
                                  double elastic)
{
  const bool over_time = reduced.quantity != fem::Quantity::dynamic_modulus;
  const bool is_creep = reduced.quantity == fem::Quantity::creep_compliance;
  const std::string what = is_creep    ? "creep_compliance_per_GPa"
                           : over_time ? "relaxation_modulus_MPa"
                                       : "dynamic_modulus_MPa";
  const std::string unit = is_creep ? "1/GPa" : "MPa";
  std::vector<Column> columns{
      {over_time ? "reduced_time_s" : "reduced_frequency_Hz", over_time ? "s" : "Hz", {}},
      {"measured_" + what, unit, {}},
      {"packing_" + what, unit, {}},
      {"error_percent", "%", {}}};
  if (!over_time) {
    columns.push_back({"measured_phase_deg", "deg", {}});
    columns.push_back({"packing_phase_deg", "deg", {}});
  }
  const double scale = is_creep ? 1e9 : 1e-6;
  const std::vector<dem::RelaxationMode> spectrum = dem::relaxation_spectrum(best.law);
  const double factor = coupling::geometry_factor(elastic, best.law);
  for (const fem::Measurement& point : reduced.points) {
    double packing = 0;
    std::vector<double> phases;
    if (is_creep)
      packing = factor * dem::creep_compliance(best.law, point.at);
    else if (over_time)
      packing = dem::relaxation(spectrum, point.at) / factor;
    else {
      const std::complex<double> e =
          1.0 / (factor * dem::complex_compliance(best.law, 2 * std::numbers::pi * point.at));
      packing = std::abs(e);
      phases = {point.phase ? *point.phase / degree : NAN, std::arg(e) / degree};
    }
    std::vector<double> row{point.at, scale * point.value, scale * packing,
                            100 * (packing / point.value - 1)};
    row.insert(row.end(), phases.begin(), phases.end());
    for (std::size_t c = 0; c < row.size(); ++c)
      columns[c].values.push_back(row[c]);
  }
  return columns;
}

double largest(const std::vector<double>& values)
{
  double result = 0;
  for (const double each : values)
    result = std::max(result, std::abs(each));
  return result;
}

std::vector<Column> ladder_columns(const std::vector<Calibrated>& ladder)
{
  std::vector<Column> columns{{"kelvin_branches_asked", "1", {}},
                              {"kelvin_branches_used", "1", {}},
                              {"rms_error_percent", "%", {}},
                              {"largest_error_percent", "%", {}},
                              {"rms_phase_error_deg", "deg", {}}};
  for (const Calibrated& each : ladder) {
    const double row[] = {double(each.n_branches), double(each.law.branches.size()),
                          100 * each.fit.relative_rms, 100 * each.fit.largest_relative_error,
                          each.fit.phase_rms ? *each.fit.phase_rms / degree : NAN};
    for (std::size_t c = 0; c < columns.size(); ++c)
      columns[c].values.push_back(row[c]);
  }
  return columns;
}

std::string ladder_text(const std::vector<Calibrated>& ladder)
{
  std::string text = "  branches  used  rms error  largest error  phase rms\n";
  for (const Calibrated& each : ladder)
    text += fmt::format("  {:>8}  {:>4}  {:>7.3g} %  {:>11.3g} %  {:>9}\n", each.n_branches,
                        each.law.branches.size(), 100 * each.fit.relative_rms,
                        100 * each.fit.largest_relative_error,
                        each.fit.phase_rms ? fmt::format("{:.2g} deg", *each.fit.phase_rms / degree)
                                           : "-");
  return text;
}

const Calibrated& chosen(const std::vector<Calibrated>& ladder, int asked, double accuracy)
{
  for (const Calibrated& each : ladder)
    if (asked > 0 ? each.n_branches == asked : each.fit.relative_rms <= accuracy)
      return each;
  return *std::ranges::min_element(ladder, {},
                                   [](const Calibrated& each) { return each.fit.relative_rms; });
}

std::vector<Calibrated> made_ladder(const fem::Measurements& data,
                                    const fem::CurveFitOptions& common, int asked, double factor)
{
  std::vector<Calibrated> ladder;
  std::string problem;
  for (int n = 1; n <= most_branches || n <= asked; ++n) {
    if (n > most_branches && n < asked)
      continue;
    try {
      ladder.push_back(calibrated(data, common, n, factor));
    } catch (const std::invalid_argument& refused) { // too few points for so many
      problem = refused.what();
      break;
    }
  }
  if (ladder.empty() || (asked > 0 && ladder.back().n_branches < asked))
    throw std::invalid_argument(problem);
  return ladder;
}

} // namespace

int calibrate_verb(const std::string& scene_file, const std::filesystem::path& file,
                   const CalibrateOptions& calibration, const RunOptions& options)
{
  LoadedScene scene = load_scene(scene_file, options.overrides);
  print_diagnostics(scene.diagnostics);
  if (scene.has_errors())
    return exit_input;
  const int asked = count_or_auto("--branches", calibration.branches, most_terms);
  const fem::Measurements data = read_fit_data(file).measurements;
  fem::CurveFitOptions common;
  common.shift = shift_named(calibration.shift);
  if (!calibration.reference.empty())
    common.reference_temperature = Units().parse(calibration.reference, "K", "degC");
  const std::filesystem::path folder =
      calibration.output.empty() ? std::filesystem::path("results") / (scene.name + "-calibration")
                                 : calibration.output;
  require_writable(folder);

  const bool from_elements = calibration.from == "element";
  const dem::CreepLaw before = only_law(*scene.scene);
  Packing packing;
  PackingStore store{from_elements ? folder / "packings" : "", {}};
  if (from_elements)
    make_folder(store.folder);
  else
    packing = options.packing ? read_packing(*options.packing, packing_recipe(*scene.scene))
                              : make_packing(scene);
  scene.scene->element.bounds = false;
  const auto elastic = [&]() -> std::optional<double> {
    return from_elements ? element_compliance(scene, store, options)
                         : specimen_compliance(scene, packing);
  };
  const std::optional<double> compliance = elastic();
  if (!compliance) {
    fmt::print("{}: interrupted; packings are kept in {}\n", scene.name, store.folder.string());
    return exit_interrupted;
  }
  const double factor = coupling::geometry_factor(*compliance, before);
  std::vector<Calibrated> ladder;
  try {
    ladder = made_ladder(data, common, asked, factor);
  } catch (const std::invalid_argument& problem) {
    throw std::invalid_argument(fmt::format("{}: {}", file.string(), problem.what()));
  }
  const Calibrated& best = chosen(ladder, asked, calibration.accuracy);

  set_law(*scene.scene, best.law);
  const std::optional<double> after = elastic();
  if (!after)
    return exit_interrupted;
  const fem::Measurements reduced = fem::reduced(data, best.fit.shift);
  const std::vector<Column> check = check_columns(reduced, best, *after);
  double against_fit = 0; // how well the packing does what the fit says
  for (std::size_t k = 0; k < reduced.points.size(); ++k)
    against_fit = std::max(against_fit,
                           std::abs(check[3].values[k] / 100 - best.fit.points[k].relative_error));

  make_folder(folder);
  const std::string section = bonds_section(best, *scene.scene, file.filename().string());
  write_text_file(folder / "bonds.inc", section);
  write_text_file(folder / "branches.csv", csv(ladder_columns(ladder)));
  write_text_file(folder / "check.csv", csv(check));
  fmt::print("{}: {}; D(t) = c J(t) with c = {:.6g} m\n{}", scene.name,
             from_elements ? "mean of the volume elements" : "the specimen over its platens",
             factor, ladder_text(ladder));
  fmt::print("  chosen: {} ({}); {} constants for {} numbers\n{}", best.n_branches,
             asked > 0 ? "asked for"
                       : fmt::format("the fewest within {:g} % rms, or the best",
                                     100 * calibration.accuracy),
             2 * best.n_branches + 2, best.fit.points.size() * (best.fit.phase_rms ? 2 : 1),
             section);
  fmt::print("  check: with this law {} gives the measured curve within "
             "{:.3g} % at the worst point, and the fitted one within {:.1g}\n",
             from_elements ? "the mean volume element" : "the specimen", largest(check[3].values),
             against_fit);
  for (const fem::FitWarning& warning : best.fit.warnings)
    fmt::print("  warning: {}\n", warning.text);
  fmt::print("  files in {}\n", folder.string());
  if (scene.scene->output.plots)
    for (const std::string& figure : make_calibration_figures(folder))
      fmt::print("  figure {}\n", figure);
  return exit_ok;
}

} // namespace apps
