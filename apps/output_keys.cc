#include "apps/output_keys.h"

#include "apps/schema.h"

namespace apps {

void declare(Schema& s, Scene::Output& v)
{
  s.section("Output", "What is written, and where.");
  s.words("Folder", v.folder, "", "For the results; empty: results/NAME-OF-THE-SCENE.");
  s.integer("History times", v.n_times, "200", between(1, 1000000),
            "Rows of the history; of haversine, block pulses and sine: cycles that are recorded "
            "(if there are more, in steps that grow).");
  s.choice<TimeSpacing>("Spacing", v.spacing,
                        {{"auto", TimeSpacing::automatic},
                         {"linear", TimeSpacing::linear},
                         {"log", TimeSpacing::logarithmic}},
                        "auto", "Of the history times; auto: log for creep, else linear.");
  s.quantity("First time", v.first_time, "s", "0.01 s", above(0),
             "First history time after 0 with log spacing.");
  s.quantities("Snapshot times", v.snapshot_times, "s", "none", at_least(0),
               "Times at which all particles and bonds are stored, besides the start and the end.");
  s.quantities("Frequencies", v.frequencies, "Hz", "0.01 Hz, 0.1 Hz, 1 Hz, 10 Hz, 25 Hz", above(0),
               "For the complex modulus (solver linear).");
  s.words("Measured", v.measured, "",
          "Table (.csv) of a creep test of the laboratory, beside this file: time [s], axial "
          "strain [%] "
          "and axial stress [kPa], or creep compliance [1/GPa]; drawn and compared.");
  s.flag("ParaView", v.paraview, "true", "Write snapshots for ParaView.");
  s.flag("Plots", v.plots, "true", "Make the figures at the end.");
  s.quantity("Checkpoint interval", v.checkpoint_interval, "s", "60 s", above(0),
             "Wall time between checkpoints.");
}

void declare(Schema& s, Scene::Study& v)
{
  s.section("Study",
            "Several runs of this scene, or several scenes, with common tables, figures and "
            "report.");
  s.words("Vary", v.vary, "",
          "Key to vary, such as 'Loading/Axial stress'; empty: a single run. Several separated by "
          "';' are combined, each value of one with each of the others; keys joined by '&' change "
          "together: 'Loading/Axial stress; Specimen/Seed & Strength/Seed'.");
  s.words("Values", v.values, "",
          "The values of each, separated by commas (or by | if they hold commas), in the form of "
          "Vary: '400 kPa, 500 kPa; 1 & 1, "
          "1 & 2'; '1..5' are the whole numbers from 1 to 5.");
  s.words("Scene files", v.scenes, "",
          "Scene files to run one after the other instead of this one, separated by commas; each "
          "has its results in a folder of its own within that of this scene.");
}

} // namespace apps
