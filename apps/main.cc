#include "apps/calibrate.h"
#include "apps/card.h"
#include "apps/extract.h"
#include "apps/files.h"
#include "apps/fit.h"
#include "apps/hard_cases.h"
#include "apps/interrupt.h"
#include "apps/plot.h"
#include "apps/point.h"
#include "apps/ranks.h"
#include "apps/run.h"
#include "apps/solver_study.h"
#include "apps/study.h"
#include "apps/text.h"
#include "apps/verbs.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <functional>
#include <stdexcept>
#include <thread>

using namespace apps;

namespace {

/// What the command line fills in.
struct Arguments {
  std::string scene, result, table, kind = "creep", output;
  std::vector<std::string> results;
  std::string resume, packing, time;
  RunOptions run;
  SolverStudyOptions study;
  CalibrateOptions calibrate;
  std::string data;
  FitOptions fit;
  CardOptions card;
  PointOptions point;
  double magnify = 1;
  bool hard = false;
};

void add_common(CLI::App& verb, Arguments& a)
{
  verb.add_option("--set", a.run.overrides,
                  "Override a key: \"Section/Key = value\"; may be repeated")
      ->allow_extra_args(false);
}

void add_run(CLI::App& app, Arguments& a, std::function<int()>& action)
{
  CLI::App* verb = app.add_subcommand("run", "Run a scene, or a study of several runs");
  verb->add_option("scene", a.scene, "Scene file");
  verb->add_option("--resume", a.resume,
                   "Go on from a checkpoint, or from the folder of an interrupted study");
  verb->add_option("--packing", a.packing, "Packing stored by 'mastic pack' for this scene");
  verb->add_option("--threads", a.run.n_threads,
                   "Threads of the explicit solver; runs at a time in a study (default: all)")
      ->check(CLI::Range(1, 1024));
  verb->add_flag("--quiet", a.run.quiet, "No progress");
  verb->add_flag("--unchecked", a.run.unchecked, "Without the sections Expect and Repeat");
  verb->add_flag("--report", a.run.for_parent)->group("");
  add_common(*verb, a);
  verb->callback([&] { action = [&] { return run_verb(a.scene, a.resume, a.packing, a.run); }; });
}

void add_study(CLI::App& app, Arguments& a, std::function<int()>& action)
{
  CLI::App* verb = app.add_subcommand(
      "study", "Speed against error: run a scene with all solvers at several settings");
  SolverStudyOptions& v = a.study;
  verb->add_option("scene", a.scene, "Scene file; with --hard a folder of them");
  verb->add_flag("--hard", a.hard,
                 "Run the scenes that say what they expect, and tell which are met (default: the "
                 "hard cases that come with the program)");
  verb->add_option("--solvers", v.ladders.solvers, "Which, separated by commas (default: all)")
      ->delimiter(',')
      ->allow_extra_args(false);
  verb->add_option("--budget", v.budget, "Wall time of a run, such as '300 s' (default)");
  verb->add_option("--threads", v.n_threads, "Threads of a run (default: 1)")
      ->check(CLI::Range(1, 1024));
  verb->add_option("--repeat", v.n_repetitions, "Times are medians of so many runs (default: 1)")
      ->check(CLI::Range(1, 1000));
  verb->add_option("--reference", v.reference,
                   "What errors are measured against: auto (default) or a solver")
      ->check(CLI::IsMember({"auto", "linear", "events", "quasistatic", "dynamic"}));
  verb->add_option("--steps", v.ladders.coarsening,
                   "quasistatic: factors on Strain per step and Error tolerance of the scene "
                   "(default: 16,8,4,2,1,0.5,0.25)")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::Range(1e-3, 1e3));
  verb->add_option("--batches", v.ladders.batches,
                   "quasistatic: values of Breakage batch (default: 256,64,16,4,1)")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::Range(1L, 1000000L));
  verb->add_option("--scalings", v.ladders.scalings,
                   "dynamic: values of Viscosity scaling (default: 1e-5,3e-5,1e-4,...,1)")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::Range(1e-12, 1.0));
  verb->add_option("--packing", v.packing, "Packing stored by 'mastic pack' for this scene");
  verb->add_option("-o,--output", v.output, "Folder (default: that of the results, with -study)");
  verb->add_flag("--quiet", v.quiet, "No progress");
  add_common(*verb, a);
  verb->callback([&] {
    if (a.scene.empty() && !a.hard)
      throw CLI::RequiredError("scene");
    action = [&] {
      a.study.overrides = a.run.overrides;
      a.run.n_threads = a.study.n_threads;
      return a.hard ? run_hard_cases(a.scene, a.run) : study_verb(a.scene, a.study);
    };
  });
}

void add_extract(CLI::App& app, Arguments& a, std::function<int()>& action)
{
  CLI::App* verb =
      app.add_subcommand("extract", "Take a constitutive law from representative volumes");
  verb->add_option("scene", a.scene, "Scene file; see its section Volume element")->required();
  verb->add_option("-o,--output", a.output, "Folder (default: that of the scene's results)");
  verb->add_option("--threads", a.run.n_threads, "Volume elements at a time (default: all)")
      ->check(CLI::Range(1, 1024));
  verb->add_flag("--quiet", a.run.quiet, "No progress");
  add_common(*verb, a);
  verb->callback([&] { action = [&] { return extract_verb(a.scene, a.output, a.run); }; });
}

void add_calibrate(CLI::App& app, Arguments& a, std::function<int()>& action)
{
  CLI::App* verb = app.add_subcommand(
      "calibrate", "Find the bond law with which a packing creeps as a measured curve says");
  CalibrateOptions& v = a.calibrate;
  verb->add_option("scene", a.scene, "Scene file with the packing")->required();
  verb->add_option("data", a.data, "Measured curve (.csv), as for 'mastic fit'")->required();
  verb->add_option("--from", v.from,
                   "What is to creep as measured: the specimen over its platens (default), or the "
                   "material: the mean volume element")
      ->check(CLI::IsMember({"specimen", "element"}));
  verb->add_option("--branches", v.branches,
                   "Kelvin branches of a bond: auto (default) or a number");
  verb->add_option("--accuracy", v.accuracy,
                   "auto takes the fewest branches with this relative rms error (default: 0.02)")
      ->check(CLI::Range(1e-12, 1.0));
  verb->add_option("--shift", v.shift,
                   "none (default), wlf, arrhenius or free: for data at several temperatures");
  verb->add_option("--reference", v.reference,
                   "Temperature of the law, such as '20 degC' (default: the measured one nearest)");
  verb->add_option("--packing", a.packing, "Packing stored by 'mastic pack' for this scene");
  verb->add_option("-o,--output", v.output, "Folder (default: results/NAME-calibration)");
  add_common(*verb, a);
  verb->callback([&] {
    action = [&] {
      if (!a.packing.empty())
        a.run.packing = a.packing;
      return calibrate_verb(a.scene, a.data, a.calibrate, a.run);
    };
  });
}

void add_fit(CLI::App& app, Arguments& a, std::function<int()>& action)
{
  CLI::App* verb = app.add_subcommand("fit", "Fit a creep law to a table of a laboratory test");
  FitOptions& v = a.fit;
  verb->add_option("data", a.table,
                   "CSV with units in its header: time [s] and creep compliance [1/GPa] or "
                   "relaxation modulus [MPa]; or frequency [Hz], dynamic modulus [MPa] and phase "
                   "angle [deg]; also temperature [degC], specimen, weight")
      ->required();
  verb->add_option("--form", v.form, "series (default), burgers, power, sigmoid or 2s2p1d");
  verb->add_option("--terms", v.terms, "Times of the series: a number, or auto (default)");
  verb->add_option("--shift", v.shift, "Temperature shift: none (default), wlf, arrhenius or free");
  verb->add_option("--reference", v.reference,
                   "Reference temperature, such as '20 degC' (default: the measured one nearest to "
                   "that)");
  verb->add_option("--poisson", v.poisson_ratio,
                   "Poisson's ratio of the isotropic law (default: 0.35)");
  verb->add_flag("--robust", v.robust, "Wild points count less (Huber weights)");
  verb->add_option("--bootstrap", v.bootstrap,
                   "95 % intervals of a series from so many drawn samples")
      ->check(CLI::Range(40, 100000));
  verb->add_option("--seed", v.seed, "Of --bootstrap (default: 1)");
  verb->add_flag("!--no-plots", v.plots, "No figures");
  verb->add_option("-o,--output", v.output, "Folder (default: results/NAME-fit)");
  verb->callback([&] { action = [&] { return fit_verb(a.table, a.fit); }; });
}

void add_others(CLI::App& app, Arguments& a, std::function<int()>& action)
{
  CLI::App* check = app.add_subcommand("check", "Say everything that is wrong with a scene");
  check->add_option("scene", a.scene, "Scene file")->required();
  add_common(*check, a);
  check->callback([&] { action = [&] { return check_verb(a.scene, a.run.overrides); }; });

  CLI::App* pack = app.add_subcommand("pack", "Make the packing of a scene and report on it");
  pack->add_option("scene", a.scene, "Scene file")->required();
  pack->add_option("-o,--output", a.output,
                   "File for the packing: .h5 (default NAME.packing.h5) or .csv");
  add_common(*pack, a);
  pack->callback([&] { action = [&] { return pack_verb(a.scene, a.output, a.run.overrides); }; });

  CLI::App* fresh = app.add_subcommand(
      "new", "Print a commented scene with every key, its unit, range and default");
  fresh->add_option("kind", a.kind,
                    "creep, constant-rate, history, cycles, network, dynamic, continuum or study");
  fresh->callback([&] { action = [&] { return new_verb(a.kind); }; });

  CLI::App* plot =
      app.add_subcommand("plot", "Draw the figures of results again, or of several together");
  plot->add_option("results", a.results, "Result folders")->required();
  plot->add_option("-o,--output", a.output, "Folder for the figures (default: the first result)");
  plot->callback([&] { action = [&] { return plot_verb(a.results, a.output); }; });

  CLI::App* report = app.add_subcommand(
      "report", "Write one HTML page: figures, tables, statistics, statements, provenance");
  report->add_option("results", a.results, "Folders of results, of studies, or that hold such")
      ->required();
  report->add_option("-o,--output", a.output, "The page (default: report.html in the first)");
  report->callback([&] { action = [&] { return report_verb(a.results, a.output); }; });

  CLI::App* picture = app.add_subcommand(
      "picture", "Render the specimen: particles, forces in the bonds, where bonds broke");
  picture->add_option("result", a.result, "Result folder")->required();
  picture->add_option("--time", a.time,
                      "Time of the snapshot, such as '100 s' (default: the last)");
  picture->add_option("--magnify", a.magnify, "Of the displacements (default: 1)")
      ->check(CLI::Range(0.0, 1e6));
  picture->add_option("-o,--output", a.output, "Folder (default: the result)");
  picture->callback(
      [&] { action = [&] { return picture_verb(a.result, a.output, a.time, a.magnify); }; });

  CLI::App* keys = app.add_subcommand("keys", "Print the reference of all keys, as Markdown");
  keys->callback([&] { action = [&] { return keys_verb(); }; });

  CLI::App* table =
      app.add_subcommand("export", "Print a table of a result as CSV, full precision");
  table->add_option("result", a.result, "Result folder or result.h5")->required();
  table
      ->add_option(
          "table", a.table,
          "history, breakages, cycles, energy, particles, bonds, complex_modulus or probes")
      ->required();
  table->add_option("--time", a.time, "Time of the snapshot, such as '100 s' (default: the last)");
  table->callback([&] { action = [&] { return export_verb(a.result, a.table, a.time); }; });

  CLI::App* info = app.add_subcommand("info", "Say where a result comes from and what is in it");
  info->add_option("result", a.result, "Result folder, result.h5, packing or checkpoint")
      ->required();
  info->callback([&] { action = [&] { return info_verb(a.result); }; });
}

void add_card(CLI::App& app, Arguments& a, std::function<int()>& action)
{
  CLI::App* verb = app.add_subcommand(
      "card", "Write a creep law as input of another program, with a check deck and its errors");
  CardOptions& card = a.card;
  verb->add_option("law", card.source, "Law file; a scene for the format pfc")->required();
  verb->add_option("--format", card.format,
                   "abaqus, ansys, ls-dyna, mfront, moose, pfc, or tables (CSV)")
      ->required();
  verb->add_option("-o,--output", card.output, "Folder (default: the law's name and the format)");
  verb->add_option("--units", card.units, "si (default) or mm: mm, t, s, MPa");
  verb->add_option("--time", card.time, "pfc: until when the law is used (default: 1e5 s)");
  verb->callback([&] { action = [&] { return card_verb(a.card); }; });
}

void add_point(CLI::App& app, Arguments& a, std::function<int()>& action)
{
  CLI::App* verb = app.add_subcommand(
      "point", "Drive a creep law at one material point by a history of strains and stresses");
  PointOptions& v = a.point;
  verb->add_option("law", v.law, "Law file")->required();
  verb->add_option("history", v.history,
                   "CSV with time [s] and, of each component xx, yy, zz, yz, xz, xy, strain_xx [%] "
                   "or stress_xx [kPa], tension positive; those left out are free of stress. "
                   "Linear between rows; two rows at one time make a jump")
      ->required();
  verb->add_option("--temperature", v.temperature,
                   "Such as '20 degC' (default: the law's reference temperature)");
  verb->add_option("--tolerance", v.tolerance, "Estimated error of a time step (default: 1e-6)")
      ->check(CLI::Range(1e-14, 0.1));
  verb->add_option("-o,--output", v.output, "File (default: standard output)");
  verb->callback([&] { action = [&] { return point_verb(a.point); }; });
}

/// What is wrong if the first word is no verb: CLI11 would say that one is missing.
std::string unknown_verb(const CLI::App& app, const std::string& word)
{
  std::vector<std::string> verbs;
  std::string all;
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; })) {
    verbs.push_back(verb->get_name());
    all += (all.empty() ? "" : ", ") + verb->get_name();
  }
  if (word.empty())
    return fmt::format("say what to do: {}; or see mastic --help", all);
  if (word.front() == '-' || std::find(verbs.begin(), verbs.end(), word) != verbs.end())
    return {};
  const std::string close = nearest(word, verbs);
  return fmt::format("there is no verb '{}'{}; verbs: {}", word,
                     close.empty() ? "" : fmt::format("; did you mean '{}'?", close), all);
}

/// Reports an error and ends the program. At once: after a failed write the clean-up of HDF5 at the
/// end of a program may crash, which would hide the exit code.
[[noreturn]] void fail(const std::exception& error, int exit_code)
{
  std::fflush(stdout);
  fmt::print(stderr, "error: {}\n", error.what());
  std::fflush(stderr);
  end_ranks(exit_code, error.what());
  std::_Exit(exit_code);
}

/// The exit code of an action, unless its output could not be written.
int finished(int exit_code)
{
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0)
    return exit_code;
  fmt::print(stderr, "error: the output cannot be written; is the disk full?\n");
  return exit_code == exit_ok ? int(exit_failure) : exit_code;
}

} // namespace

int main(int argc, char** argv)
{
  CLI::App app{"Mastic: creep and breakage of asphalt and other bonded granular materials."};
  app.name("mastic");
  app.require_subcommand(1);
  app.set_help_all_flag("--help-all", "Print the help of all verbs and exit");
  app.set_version_flag("--version", std::string("mastic " MASTIC_VERSION " (" MASTIC_REVISION ")"));
  app.footer(
      "A first scene: mastic new creep > my.scene; mastic check my.scene; mastic run my.scene\n"
      "Exit codes: 0 done, 1 not as the scene expects, 2 wrong input, 3 a computation failed, 4 "
      "interrupted with a "
      "checkpoint, 5 the specimen lost its equilibrium.");
  Arguments arguments;
  arguments.run.n_threads = int(std::max(1u, std::thread::hardware_concurrency()));
  std::function<int()> action;
  add_run(app, arguments, action);
  add_study(app, arguments, action);
  add_extract(app, arguments, action);
  add_calibrate(app, arguments, action);
  add_fit(app, arguments, action);
  add_others(app, arguments, action);
  add_card(app, arguments, action);
  add_point(app, arguments, action);
  if (const std::string problem = unknown_verb(app, argc > 1 ? argv[1] : ""); !problem.empty()) {
    fmt::print(stderr, "error: {}\n", problem);
    return exit_input;
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ExtrasError& error) {
    fmt::print(stderr, "error: {}{}\n", error.what(),
               arguments.run.overrides.empty()
                   ? ""
                   : "; settings need quotes: --set \"Loading/Axial stress = 500 kPa\"");
    return exit_input;
  } catch (const CLI::ParseError& error) {
    const int code = app.exit(error);
    return code == 0 ? exit_ok : exit_input;
  }
  catch_interrupts(!arguments.run.for_parent);
  try {
    if (started_by_mpirun())
      Ranks(); // from here on only the first one speaks
    const int code = finished(action());
    end_ranks(code, "");
    return code;
  } catch (const std::invalid_argument& error) {
    fail(error, exit_input);
  } catch (const std::exception& error) {
    fail(error, exit_failure);
  }
}
