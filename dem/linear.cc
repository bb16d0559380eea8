#include "dem/linear.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace dem {

namespace {

/// Sum over the steps and ramps of a loading before a time, each by what it adds to the load: times
/// the kernel, or the mean of the kernel over the ramp.
template <typename Kernel, typename Mean>
double superposition(const Loading& loading, double time, Kernel&& kernel, Mean&& mean)
{
  double sum = 0, value = 0;
  const std::vector<LoadPoint>& points = loading.points;
  for (std::size_t k = 0; k < points.size() && points[k].time <= time; ++k) {
    const auto& [begin, load] = points[k];
    if (k == 0 || begin == points[k - 1].time)
      sum += (load - value) * kernel(time - begin);
    value = load;
    if (k + 1 == points.size() || points[k + 1].time <= begin || time <= begin)
      continue;
    const double length = points[k + 1].time - begin, gone = std::min(length, time - begin);
    sum += (points[k + 1].value - load) * (gone / length) * mean(time - begin - gone, gone);
    value = points[k + 1].value;
  }
  return sum;
}

void refuse_true_stress(const Loading& loading)
{
  if (loading.true_stress)
    throw std::invalid_argument("the linear solver takes nominal stress only");
}

/// Segment that begins at a breakpoint after another one.
ForceSegment following(const LinearModel& model, const Loading& loading, const ForceSegment& before,
                       double time)
{
  const double dt = time - before.start, value = load_value(loading, time);
  ForceSegment next{time, value, load_rate(loading, time), model.compliance, {}, before.jumps};
  next.state = creep_step(model.creep, before.state, before.compliance * before.load_rate * dt, dt);
  next.jumps += model.compliance * value - next.state.elastic;
  next.state.elastic = model.compliance * value;
  return next;
}

DisplacementSegment following(const LinearModel& model, const Loading& loading,
                              const DisplacementSegment& before, double time)
{
  const double dt = time - before.start, value = load_value(loading, time);
  DisplacementSegment next{time, value, load_rate(loading, time), {}, 0, before.jumps};
  next.modes = relaxation_step(model.spectrum, before.modes, before.rate * dt, dt);
  const double jump = value - (before.displacement + before.rate * dt);
  for (std::size_t i = 0; i < next.modes.size(); ++i)
    next.modes[i] += model.spectrum[i].stiffness * jump;
  next.jumps += jump;
  return next;
}

} // namespace

LinearModel make_linear_model(const Assembly& assembly, std::size_t most_factored)
{
  validate(assembly);
  refuse_confinement(assembly, "linear");
  const std::optional<ProportionalLaws> laws = proportional_laws(assembly.laws);
  if (!laws)
    throw std::invalid_argument("the linear solver needs bond laws that are proportional to each "
                                "other: one function of time for all bonds");
  LinearModel model;
  model.network = make_network(assembly);
  model.creep = network_creep(laws->creep).law;
  model.spectrum = relaxation_spectrum(model.creep);
  const NetworkSolver solver(model.network, undamaged(model.network), most_factored);
  if (!solver.response())
    throw std::runtime_error("the network cannot carry the load: " + solver.obstacle());
  model.unit_response = *solver.response();
  model.statistics = solver.statistics();
  const Eigen::VectorXd& load = model.network.unit_load;
  model.compliance = load.isZero(0) ? 0 : load.dot(model.unit_response) / load.norm();
  model.area = assembly.area;
  model.gauge_length = assembly.gauge_length;
  return model;
}

double creep_compliance(const LinearModel& model, double t)
{
  return model.compliance * model.area / model.gauge_length * creep_compliance(model.creep, t);
}

std::complex<double> complex_modulus(const LinearModel& model, double omega)
{
  return complex_modulus(model.creep, model.compliance * model.area / model.gauge_length, omega);
}

std::complex<double> complex_modulus(const CreepLaw& creep, double elastic, double omega)
{
  return 1.0 / (elastic * complex_compliance(creep, omega));
}

LinearResponse linear_response(const LinearModel& model, const Loading& loading, double time)
{
  refuse_true_stress(loading);
  const double prescribed = load_value(loading, time);
  if (loading.control == Loading::Control::displacement)
    return {superposition(
                loading, time, [&](double t) { return relaxation(model.spectrum, t); },
                [&](double begin, double length) {
                  return mean_relaxation(model.spectrum, begin, length);
                }) /
                model.compliance,
            prescribed};
  const double creep = superposition(
      loading, time, [&](double t) { return creep_compliance(model.creep, t); },
      [&](double begin, double length) {
        return mean_creep_compliance(model.creep, begin, length);
      });
  return {prescribed, model.compliance * creep};
}

LoadHistory linear_history(const LinearModel& model, const Loading& loading)
{
  refuse_true_stress(loading);
  LoadHistory history{{model.creep, model.spectrum}, {}, model.gauge_length};
  const auto follow = [&](auto segment) {
    for (double time = segment.start; std::isfinite(time); time = next_breakpoint(loading, time)) {
      segment = following(model, loading, segment, time);
      history.segments.push_back(segment);
    }
  };
  const double start = loading.points.front().time;
  if (loading.control == Loading::Control::force)
    follow(ForceSegment{start, 0, 0, model.compliance, virgin_state(model.creep)});
  else
    follow(DisplacementSegment{start, 0, 0, RelaxationState(model.spectrum.size(), 0.0)});
  return history;
}

Eigen::VectorXd displacements(const LinearModel& model, const Loading& loading, double time)
{
  if (model.compliance == 0)
    return Eigen::VectorXd::Zero(model.network.n_dofs);
  return linear_response(model, loading, time).displacement / model.compliance *
         model.unit_response;
}

Eigen::VectorXd elastic_displacements(const LinearModel& model, const Loading& loading, double time)
{
  return linear_response(model, loading, time).force * model.unit_response;
}

} // namespace dem
