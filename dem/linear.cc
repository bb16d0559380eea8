#include "dem/linear.h"

#include <algorithm>
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

} // namespace

LinearModel make_linear_model(const Assembly& assembly)
{
  validate(assembly);
  const std::optional<ProportionalLaws> laws = proportional_laws(assembly.laws);
  if (!laws)
    throw std::invalid_argument("the linear solver needs bond laws that are proportional to each "
                                "other: one function of time for all bonds");
  LinearModel model;
  model.network = make_network(assembly);
  model.creep = network_creep(laws->creep).law;
  model.spectrum = relaxation_spectrum(model.creep);
  const NetworkSolver solver(model.network, undamaged(model.network));
  if (!solver.response())
    throw std::runtime_error("the network cannot carry the load: " + solver.obstacle());
  model.unit_response = *solver.response();
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
  const double elastic = model.compliance * model.area / model.gauge_length;
  return 1.0 / (elastic * complex_compliance(model.creep, omega));
}

LinearResponse linear_response(const LinearModel& model, const Loading& loading, double time)
{
  if (loading.true_stress)
    throw std::invalid_argument("the linear solver takes nominal stress only");
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
