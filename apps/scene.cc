#include "apps/scene.h"

#include "apps/loading_keys.h"
#include "apps/output_keys.h"
#include "apps/text.h"

#include <fmt/format.h>

#include <algorithm>

namespace apps {

namespace {

constexpr const char* law_prefix = "Bond law ";
constexpr const char* boundary_prefix = "Boundary ";
constexpr const char* region_prefix = "Region ";

std::string grading_list()
{
  std::string all;
  for (const std::string_view name : dem::grading_names())
    all += std::string(name) + ", ";
  return all + "or 'table'";
}

void declare_top(Schema& s, Scene& scene)
{
  s.section("", "");
  s.words("Title", scene.title, "", "One line for figures and results.");
  s.choice<SolverChoice>(
      "Solver", scene.solver,
      {{"auto", SolverChoice::automatic},
       {"linear", SolverChoice::linear},
       {"events", SolverChoice::events},
       {"quasistatic", SolverChoice::quasistatic},
       {"dynamic", SolverChoice::dynamic},
       {"continuum", SolverChoice::continuum}},
      "auto",
      "linear: intact, small displacements, exact. events: exact from one bond "
      "breakage to the next, "
      "small displacements. quasistatic: implicit steps, finite motion, friction, "
      "any laws, no inertia. dynamic: explicit with inertia, friction, finite "
      "motion. continuum: no particles, finite elements with the creep law of a file (sections "
      "Body, Boundary NAME, Region NAME, Continuum, Probes). auto takes the "
      "cheapest of the others whose assumptions hold and says which and why.");
  s.quantity("Small strain", scene.small_strain, "%", "1 %", above(0),
             "auto goes on with the quasi-static solver when the specimen has strained so much and "
             "bonds break: up to there displacements are taken as small.");
  s.flag("Accept unusual values", scene.accept_unusual, "false",
         "Radii, densities and stiffnesses far from those of stone and binder are refused unless "
         "this is true: most often they come from a wrong unit.");
}

void declare_specimen(Schema& s, Scene::Specimen& v)
{
  s.section("Specimen", "The packing of spheres and which of them are bonded.");
  s.choice<SpecimenSource>("Source", v.source,
                           {{"generate", SpecimenSource::generate}, {"file", SpecimenSource::file}},
                           "generate", "Make the packing, or read it from File.");
  s.words(
      "File", v.file, "",
      "Packing to read: .h5 from 'mastic pack', or .csv with a header of names and units: x_mm, "
      "y_mm, z_mm, r_mm, and if needed class, held (free, bottom, top), fx_N, fy_N, fz_N, "
      "mx_N_m, my_N_m, mz_N_m (loads per unit of the load factor).");
  s.words(
      "Bond file", v.bond_file, "",
      "Bonds to read (.csv): a, b are particles counted from 0 in the order of File; if wanted, "
      "normal_strength_N and shear_strength_N. Empty: bonds by the rule below.");
  s.quantity("Diameter", v.diameter, "mm", "60.2 mm", above(0), "Of the cylindrical specimen.");
  s.quantity("Height", v.height, "mm", "120.3 mm", above(0), "Of the specimen to be generated.");
  s.integer("Particles", v.n_particles, "6000", at_least(1), "Number of spheres to generate.");
  s.number("Solid fraction", v.solid_fraction, "0.7", Bounds{0, 0.9, false, false},
           "Volume of the spheres over volume of the cylinder.");
  s.words("Grading", v.grading, "sma10",
          "Sizes of the spheres: " + grading_list() +
              ". The named ones are estimates for a 0-10 mm stone mastic asphalt above 2 mm.");
  s.pairs(
      "Grading table", v.grading_table, "mm", "%", "",
      "Sieve opening: share of the mass that passes; from 0 % to 100 %. For Grading = table. Mass "
      "is spread evenly over the logarithm of the size between two sieves.");
  s.integer("Minimum contacts", v.min_contacts, "4", between(0, 6),
            "Every sphere gets at least so many contacts (walls included).");
  s.number("Contact gap", v.contact_gap, "0.001", Bounds{0, 0.1, false, false},
           "Gap that counts as contact when the packing is made, over the smaller radius.");
  s.quantity("Residual stress bound", v.residual_stress_bound, "kPa", "30 kPa", above(0),
             "Isotropic stress that the packing may keep: 1 % of the strength of the specimen.");
  s.quantity("Preparation stiffness", v.preparation_stiffness, "N/m", "3e6 N/m", above(0),
             "Of the contacts while the packing is made, for the residual stress.");
  s.quantity("Density", v.density, "kg/m^3", "2700 kg/m^3", above(0), "Of the spheres.");
  s.integer("Seed", v.seed, "1", at_least(0), "Of the packing.");
  s.choice<BondRule>("Bond by", v.bond_rule,
                     {{"mean contacts", BondRule::mean_contacts}, {"gap", BondRule::gap}},
                     "mean contacts",
                     "Bond the nearest pairs until the mean number of bonds per sphere is reached, "
                     "or all pairs up to a gap.");
  s.number("Mean contacts", v.mean_contacts, "5.5", above(0), "Bonds at each sphere, in the mean.");
  s.number("Bond gap", v.bond_gap, "0.001", between(0, 0.5),
           "Largest gap that is bonded, over the smaller radius. For Bond by = gap.");
  s.number("Platen gap", v.platen_gap, "0.001", between(0, 1),
           "Spheres nearer to a platen than this times their radius are glued to it. Not used if "
           "File has a column 'held'.");
  s.optional_quantity("Gauge length", v.gauge_length, "height", "mm", "height", above(0),
                      "Strain is the displacement of the upper platen over this length.");
}

void declare_law(Schema& s, BondLawInput& v)
{
  s.quantity("Maxwell stiffness", v.maxwell_stiffness, "N/m", "3.2e6 N/m", above(0),
             "Spring in series, normal direction (the paper's K_m, PFC's bur_knm).");
  s.optional_quantity("Maxwell viscosity", v.maxwell_viscosity, "none", "N s/m", "8.2e8 N s/m",
                      above(0),
                      "Dashpot in series (C_m, bur_cnm); 'none' for a solid that does not flow.");
  s.quantities(
      "Kelvin stiffness", v.kelvin_stiffness, "N/m", "5.0e5 N/m", at_least(0),
      "Springs of the Kelvin branches (K_k, bur_knk), one per branch; one branch makes the "
      "Burgers law.");
  s.quantities("Kelvin viscosity", v.kelvin_viscosity, "N s/m", "8.4e6 N s/m", at_least(0),
               "Dashpots of the Kelvin branches (C_k, bur_cnk); retardation time = viscosity / "
               "stiffness; 0: the spring acts at once.");
  s.number("Normal to shear ratio", v.normal_to_shear, "11", above(0),
           "N/S: shear and torsion have all constants of the normal direction divided by it.");
  s.number("Radius multiplier", v.radius_multiplier, "1", Bounds{0, 10, false, true},
           "lambda: radius of the bond's section over the radius of the smaller sphere.");
}

void declare_bonds(Schema& s, Scene& scene, const std::vector<std::string>& law_names)
{
  s.section("Bonds", "The creep law of the bonds.");
  s.choice<BondPreset>(
      "Preset", scene.preset, {{"estimate", BondPreset::estimate}, {"none", BondPreset::none}},
      "estimate",
      "estimate: keys of Bonds and Strength that are not set take estimated values (the defaults "
      "shown here), not those of the paper's tables, which could not be obtained. none: they must "
      "be set.");
  declare_law(s, scene.bonds);
  s.choice<dem::AfterBreakage>(
      "After breakage", scene.after_breakage,
      {{"leave", dem::AfterBreakage::leave},
       {"pressed", dem::AfterBreakage::pressed},
       {"friction", dem::AfterBreakage::friction}},
      "pressed",
      "A broken bond leaves; or stays as a contact without friction while it is pressed; or as one "
      "with friction (solvers quasistatic and dynamic).");
  s.number("Friction", scene.friction, "0.5", at_least(0),
           "Coefficient of contacts with friction (solvers quasistatic and dynamic).");
  for (const std::string& name : law_names) {
    auto& law = scene.more_bonds[name];
    law = std::make_unique<BondLawInput>();
    s.section(law_prefix + name, "A law for some pairs of particle classes.");
    s.pairs("Classes", law->class_pairs, "1", "1", "",
            "Pairs of classes bonded by this law, such as '0: 1, 1: 1'.");
    declare_law(s, *law);
  }
}

void declare_temperature(Schema& s, Scene::Temperature& v)
{
  s.section("Temperature", "Shift of all viscosities with temperature.");
  s.quantity("Temperature", v.temperature, "degC", "20 degC", above(-273.15), "Of the test.");
  s.pairs("Temperature history", v.history, "s", "degC", "",
          "Instead of Temperature: 'time: temperature' in order, linear between the points, the "
          "same time twice makes a jump; the last one holds on (solver quasistatic).");
  s.quantity("Reference temperature", v.reference, "degC", "20 degC", above(-273.15),
             "For which the bond laws hold as they are.");
  s.choice<ShiftKind>(
      "Shift law", v.shift,
      {{"none", ShiftKind::none}, {"WLF", ShiftKind::wlf}, {"Arrhenius", ShiftKind::arrhenius}},
      "none", "How the viscosities depend on temperature.");
  s.number("WLF C1", v.wlf_c1, "19", above(0), "Of log10 aT = -C1 (T - Tref) / (C2 + T - Tref).");
  s.quantity("WLF C2", v.wlf_c2, "K", "92 K", above(0), "Of the same.");
  s.quantity("Activation energy", v.activation_energy, "kJ/mol", "200 kJ/mol", above(0),
             "Of ln aT = E / R (1/T - 1/Tref).");
}

void declare_strength(Schema& s, Scene::Strength& v)
{
  s.section("Strength", "Strength of the bonds at the reference strain rate, and its rate law.");
  s.choice<StrengthKind>("Distribution", v.kind,
                         {{"none", StrengthKind::none},
                          {"normal", StrengthKind::normal},
                          {"Weibull", StrengthKind::weibull}},
                         "normal", "none: bonds do not break, whatever Bond file says.");
  s.quantity("Mean", v.mean, "N", "54 N", any(), "Of the normal distribution.");
  s.quantity("Standard deviation", v.standard_deviation, "N", "44 N", above(0),
             "Of the normal distribution.");
  s.number("Modulus", v.modulus, "1.1", above(0), "Of the Weibull distribution.");
  s.quantity("Scale", v.scale, "N", "60 N", above(0), "Of the Weibull distribution.");
  s.choice<dem::NonpositiveRule>("Nonpositive draws", v.rule,
                                 {{"clamp", dem::NonpositiveRule::clamp},
                                  {"truncate", dem::NonpositiveRule::truncate},
                                  {"resample", dem::NonpositiveRule::resample},
                                  {"error", dem::NonpositiveRule::error}},
                                 "clamp",
                                 "What becomes of the 11 % of normal(54, 44) N that come out <= 0: "
                                 "strength 0; cut off; drawn again; or the scene is refused.");
  s.number("Shear to normal ratio", v.shear_ratio, "1", above(0),
           "Shear strength over tensile strength of a bond.");
  s.integer("Seed", v.seed, "1", at_least(0), "Of the strengths; each bond has a draw of its own.");
  s.number("Rate exponent", v.rate_law.exponent, "0.325", between(0, 2),
           "Strength ~ strain rate ^ exponent (eq. 5 of the paper); 0 switches it off.");
  s.quantity("Reference rate", v.rate_law.reference_rate, "1/s", "0.005 1/s", above(0),
             "Strain rate at which the distribution holds.");
  s.quantity(
      "Rate window", v.rate_law.window, "s", "1 s", at_least(0),
      "The strain rate is averaged over this time, without elastic jumps; 0: instantaneous.");
  s.number("Rate window fraction", v.rate_law.window_fraction, "0.01", between(0, 1),
           "... or over this share of the time since the start, if that is longer.");
  s.quantity("Rate floor", v.rate_law.floor, "1/s", "1e-7 1/s", at_least(0),
             "The strain rate never counts as less.");
}

void declare_quasistatic(Schema& s, dem::QuasistaticSettings& v)
{
  s.section("Quasistatic", "The implicit solver.");
  s.number("Strain per step", v.strain_per_step, "5e-4", Bounds{0, 0.1, false, true},
           "Largest change of the specimen's strain in a step.");
  s.number("Error tolerance", v.error_tolerance, "1e-3", Bounds{0, 1, false, true},
           "Estimated error of the strain gained in a step, over what is gained.");
  s.integer("Breakage batch", v.breakage_batch, "16", at_least(1),
            "Bonds that may break before equilibrium is sought again; 1: one after the other, each "
            "at its time.");
  s.number("Residual tolerance", v.residual_tolerance, "1e-5", Bounds{0, 1e-2, false, true},
           "Force out of balance, over the largest force between two particles.");
  s.number("Regularisation", v.regularisation, "1e-3", Bounds{0, 1, false, true},
           "Viscous resistance of contacts to sliding and rolling within a step, over their "
           "stiffness, so that particles that hang loose do not drift; its share of the energy is "
           "reported.");
  s.number("Passage limit", v.passage_limit, "1 %", Bounds{0, 10, false, true},
           "A specimen that strains by so much without finding an equilibrium has ruptured.");
  s.choice<dem::Geometry>("Geometry", v.geometry,
                          {{"finite", dem::Geometry::finite}, {"small", dem::Geometry::small}},
                          "finite",
                          "finite: equilibrium on the present geometry. small: on that of the "
                          "start, as the solvers linear and events assume.");
}

void declare_dynamic(Schema& s, Scene& scene)
{
  dem::DynamicSettings& v = scene.dynamic;
  s.section("Dynamic", "The explicit solver.");
  s.number("Viscosity scaling", v.viscosity_scaling, "0.001", Bounds{0, 1, false, true},
           "x: all viscosities are multiplied by x, so that a time t is simulated in x t. Loads, "
           "results and the rate law stay in real time. Smaller is faster and less accurate.");
  s.number("Step safety", v.step_safety, "0.8", Bounds{0, 1, false, true},
           "Time step over the largest stable one.");
  s.number("Local damping", v.damping, "0.7", Bounds{0, 1, true, false},
           "Cundall's: share of the out-of-balance force that brakes.");
  s.number("Ramp", v.ramp_periods, "4", at_least(0),
           "Jumps of the load are spread over so many periods of the first axial vibration.");
  s.number("Smallest rate window", v.smallest_window, "1", at_least(0),
           "The strain rate is averaged over so many periods at least.");
  s.number("Servo gain", v.servo_gain, "0.5", Bounds{0, 1, false, true},
           "Of the platens under prescribed force.");
  s.flag("Audit", scene.audit, "true",
         "Compare with the event or linear solver, where they apply, and print the error that the "
         "viscosity scaling causes.");
}

/// NAME of all sections "PREFIX NAME".
std::vector<std::string> names_after(const char* prefix, const std::vector<SceneEntry>& entries)
{
  std::vector<std::string> names;
  for (const SceneEntry& entry : entries)
    if (entry.sections.size() == 1 && entry.sections[0].starts_with(prefix)) {
      const std::string name = trimmed(entry.sections[0].substr(std::string(prefix).size()));
      if (std::find(names.begin(), names.end(), name) == names.end())
        names.push_back(name);
    }
  return names;
}

/// Takes out the entries of sections such as 'Bond law' that have no name, and says so.
void refuse_nameless(const char* prefix, SceneText& scanned)
{
  const auto nameless = [&](const SceneEntry& entry) { return entry.section() == trimmed(prefix); };
  const auto first = std::ranges::find_if(scanned.entries, nameless);
  if (first == scanned.entries.end())
    return;
  scanned.diagnostics.push_back(
      {Diagnostic::Kind::error, first->place,
       fmt::format("give it a name: 'subsection {} NAME'", trimmed(prefix))});
  std::erase_if(scanned.entries, nameless);
}

} // namespace

void declare(Schema& schema, Scene& scene, const NamedSections& names)
{
  declare_top(schema, scene);
  declare_specimen(schema, scene.specimen);
  declare_bonds(schema, scene, names.laws);
  declare_temperature(schema, scene.temperature);
  declare_strength(schema, scene.strength);
  declare_loading(schema, scene.load);
  declare_quasistatic(schema, scene.quasistatic);
  declare_dynamic(schema, scene);
  declare(schema, scene.output);
  declare(schema, scene.study);
  declare(schema, scene.element);
  declare(schema, scene.continuum, names.boundaries, names.regions);
  declare(schema, scene.expect);
  declare(schema, scene.repeat);
}

bool LoadedScene::has_errors() const
{
  return std::ranges::any_of(diagnostics,
                             [](const Diagnostic& d) { return d.kind == Diagnostic::Kind::error; });
}

namespace {

const std::vector<std::string> bond_estimates{"Bonds/Maxwell stiffness", "Bonds/Maxwell viscosity",
                                              "Bonds/Kelvin stiffness", "Bonds/Kelvin viscosity",
                                              "Bonds/Radius multiplier"};

/// Those of the keys that have their estimated value, typed or not, if the scene stands on
/// estimates: a run of a study has all keys typed.
std::string estimated(const LoadedScene& scene, const std::vector<std::string>& keys)
{
  std::string list;
  if (scene.scene->preset != BondPreset::estimate)
    return list;
  for (const std::string& key : keys)
    if (scene.schema->is_default(key))
      list += (list.empty() ? "" : ", ") + key.substr(key.find('/') + 1);
  return list;
}

} // namespace

std::string estimated_bond_keys(const LoadedScene& scene)
{
  return estimated(scene, bond_estimates);
}

std::string estimated_keys(const LoadedScene& scene)
{
  std::vector<std::string> keys = bond_estimates;
  if (scene.scene->strength.kind != StrengthKind::none)
    keys.insert(keys.end(), {"Strength/Nonpositive draws", "Strength/Shear to normal ratio",
                             "Strength/Rate window", "Strength/Rate floor"});
  return estimated(scene, keys);
}

LoadedScene load_scene_text(const std::string& text, const std::string& name,
                            const std::filesystem::path& folder,
                            const std::vector<std::string>& overrides)
{
  LoadedScene loaded;
  loaded.folder = folder;
  loaded.name = std::filesystem::path(name).stem().string();
  loaded.text = text;
  SceneText scanned = scan_scene(text, name, folder);
  for (const char* prefix : {law_prefix, boundary_prefix, region_prefix})
    refuse_nameless(prefix, scanned);
  loaded.diagnostics = scanned.diagnostics;
  for (const std::string& each : overrides)
    try {
      scanned.entries.push_back(override_entry(each));
    } catch (const std::invalid_argument& error) {
      loaded.diagnostics.push_back({Diagnostic::Kind::error, "--set", error.what()});
    }
  loaded.scene = std::make_unique<Scene>();
  loaded.units = std::make_unique<Units>();
  loaded.schema = std::make_unique<Schema>(*loaded.units);
  declare(*loaded.schema, *loaded.scene,
          {names_after(law_prefix, scanned.entries), names_after(boundary_prefix, scanned.entries),
           names_after(region_prefix, scanned.entries)});
  for (Diagnostic& each : loaded.schema->apply(scanned.entries))
    loaded.diagnostics.push_back(std::move(each));
  try {
    read_expectations(loaded.scene->expect, *loaded.units);
  } catch (const std::invalid_argument& problem) {
    loaded.diagnostics.push_back({Diagnostic::Kind::error, "Expect", problem.what()});
  }
  if (!loaded.has_errors())
    for (Diagnostic& each : check_consistency(*loaded.scene, *loaded.schema))
      loaded.diagnostics.push_back(std::move(each));
  return loaded;
}

LoadedScene load_scene(const std::filesystem::path& file, const std::vector<std::string>& overrides)
{
  return load_scene_text(read_text_file(file), file.string(), file.parent_path(), overrides);
}

} // namespace apps
