#include "apps/loading_keys.h"

namespace apps {

namespace {

void declare_cycles(Schema& s, Scene::Load& v)
{
  s.quantity("Peak stress", v.peak_stress, "kPa", "600 kPa", any(), "For haversine, block pulses.");
  s.number("Contact share", v.contact_share, "0.05", Bounds{0, 1, true, false},
           "For haversine, block pulses: stress between the pulses, over Peak stress.");
  s.quantity("Loading time", v.loading_time, "s", "0.1 s", above(0),
             "For haversine, block pulses: duration of a pulse.");
  s.quantity("Rest time", v.rest_time, "s", "0.9 s", at_least(0),
             "For haversine, block pulses: after each pulse.");
  s.quantity("Mean stress", v.mean_stress, "kPa", "0 kPa", any(), "For sine.");
  s.quantity("Stress amplitude", v.stress_amplitude, "kPa", "100 kPa", any(),
             "For sine: from the mean to the peak.");
  s.quantity("Frequency", v.frequency, "Hz", "1 Hz", above(0), "For sine.");
  s.integer("Cycles", v.n_cycles, "1000", between(1, 1000000),
            "For haversine, block pulses, sine: number of pulses.");
  s.integer("Points per pulse", v.points_per_pulse, "16", between(4, 1000),
            "For haversine and sine, a multiple of 4: the curve becomes so many straight lines. "
            "Largest error with n of them, over the amplitude: 2.5 / n^2 (haversine), 4.9 / n^2 "
            "(sine); the mean over a pulse is exact.");
}

} // namespace

void declare_loading(Schema& s, Scene::Load& v)
{
  s.section("Loading", "The test. Compression is positive.");
  s.choice<TestKind>(
      "Test", v.test,
      {{"creep", TestKind::creep},
       {"constant rate", TestKind::constant_rate},
       {"stress history", TestKind::stress_history},
       {"strain history", TestKind::strain_history},
       {"haversine", TestKind::haversine},
       {"block pulses", TestKind::block_pulses},
       {"sine", TestKind::sine},
       {"particle loads", TestKind::particle_loads},
       {"boundary loads", TestKind::boundary_loads}},
      "creep",
      "creep: Axial stress from time 0. constant rate: Strain rate. Histories: "
      "piecewise linear. haversine, block pulses: pulses of Peak stress, each with a "
      "rest. sine: Stress amplitude about Mean stress. particle loads: those of the "
      "particle file, from time 0. boundary loads: those of the sections Boundary NAME of a "
      "continuum and its weight, from time 0 or by Load factor history.");
  s.quantity("Axial stress", v.stress, "kPa", "400 kPa", any(), "For creep.");
  s.flag("True stress", v.true_stress, "false",
         "Tests at prescribed stress: stress on the present area (of a specimen that keeps its "
         "volume) instead of the initial one.");
  s.optional_quantity(
      "Release time", v.release_time, "never", "s", "never", above(0),
      "For creep and boundary loads: the load goes to 0 and the specimen recovers.");
  s.quantity("Strain rate", v.strain_rate, "1/s", "0.005 1/s", any(), "For constant rate.");
  s.quantity("End time", v.end_time, "s", "2000 s", at_least(0),
             "Of creep, particle loads and boundary loads.");
  s.optional_quantity("End strain", v.end_strain, "none", "%", "5 %", above(0),
                      "Of constant rate.");
  s.quantity("Strain limit", v.strain_limit, "%", "10 %", above(0),
             "The run ends when the specimen has strained so much in either direction.");
  s.pairs("Stress history", v.stress_history, "s", "kPa", "",
          "'time: stress' in order; the same time twice makes a jump.");
  s.pairs("Strain history", v.strain_history, "s", "%", "",
          "'time: strain' in order; the same time twice makes a jump.");
  s.pairs("Load factor history", v.factor_history, "s", "1", "",
          "For boundary loads: 'time: factor' in order; the same time twice makes a jump.");
  s.quantity("Confining stress", v.confining_stress, "kPa", "0 kPa", at_least(0),
             "Constant pressure on the lateral surface, in full from the start, as dead forces on "
             "the spheres there (solver quasistatic), or on the side of a continuum. The axial "
             "stress stays the total one at the "
             "platens: the deviator is their difference.");
  declare_cycles(s, v);
}

} // namespace apps
