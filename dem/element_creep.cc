#include "dem/element_creep.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>

namespace dem {

namespace {

std::vector<LawStep> law_steps(const ElementModel& model, StepScheme scheme, double duration)
{
  std::vector<LawStep> result;
  for (const CreepLaw& law : model.laws)
    result.push_back(law_step(law, scheme, duration, model.n_parts));
  return result;
}

std::vector<double> stiffnesses(std::span<const LawStep> steps)
{
  std::vector<double> result;
  for (const LawStep& step : steps)
    result.push_back(step.stiffness());
  return result;
}

/// Memory of the modes of a bond, one column each.
using Memory = Eigen::Map<Eigen::MatrixXd>;
using ConstMemory = Eigen::Map<const Eigen::MatrixXd>;

ConstMemory memory_of(const ElementState& state, std::size_t bond, int n_parts)
{
  return {state.memory.data() + bond * 6 * std::size_t(n_parts), n_parts, 6};
}

MacroLoad unit_stress(int component)
{
  return {{true, true, true, true, true, true}, Vec6::Unit(component)};
}

/// Six creep tests side by side.
using CreepTests = std::vector<ElementState>;

Mat6 strains(const CreepTests& tests)
{
  Mat6 result;
  for (int k = 0; k < 6; ++k)
    result.col(k) = tests[std::size_t(k)].strain;
  return result;
}

/// Steps of the lengths used last.
class StepStore {
public:
  explicit StepStore(const ElementModel& model) : model_(model) {}

  const ElementStep& step(StepScheme scheme, double duration)
  {
    const auto found = std::ranges::find_if(
        steps_, [&](const auto& each) { return each->duration() == duration; });
    if (found != steps_.end())
      return **found;
    if (steps_.size() == most_kept)
      steps_.erase(steps_.begin());
    ++n_factorisations_;
    return *steps_.emplace_back(std::make_unique<ElementStep>(model_, scheme, duration));
  }
  int n_factorisations() const { return n_factorisations_; }

private:
  static constexpr std::size_t most_kept = 4;
  const ElementModel& model_;
  std::vector<std::unique_ptr<ElementStep>> steps_;
  int n_factorisations_ = 0;
};

CreepTests crept(const ElementModel& model, CreepTests tests, const ElementStep& step, int n_steps)
{
  for (int k = 0; k < 6; ++k)
    for (int s = 0; s < n_steps; ++s)
      tests[std::size_t(k)] = step.advance(model, tests[std::size_t(k)], unit_stress(k));
  return tests;
}

void validate(std::span<const double> times, double tolerance)
{
  if (!(tolerance > 0) || !std::isfinite(tolerance))
    throw std::invalid_argument(
        fmt::format("creep: the tolerance must be > 0, found {:g}", tolerance));
  double last = 0;
  for (std::size_t k = 0; k < times.size(); ++k) {
    const bool is_later = k == 0 ? times[k] >= 0 : times[k] > last;
    if (!is_later || !std::isfinite(times[k]))
      throw std::invalid_argument(
          fmt::format("creep: times must be >= 0 and increase, found {:g} s", times[k]));
    last = times[k];
  }
}

} // namespace

ElementModel make_element_model(const VolumeElement& element)
{
  if (!element.is_periodic)
    throw std::invalid_argument("creep in time: the volume element must be periodic");
  ElementModel model{make_macro_network(element), {}, {}, 1};
  model.pins = rigid_motion_pins(find_clusters(element, model.macro.status), model.macro.network);
  for (const BondLaw& law : element.laws) {
    model.laws.push_back(law.creep);
    model.n_parts = std::max(model.n_parts, 1 + int(law.creep.branches.size()));
  }
  return model;
}

ElementState virgin_state(const ElementModel& model)
{
  ElementState state;
  state.dofs = Eigen::VectorXd::Zero(model.macro.n_dofs());
  state.memory.assign(model.macro.bonds.size() * 6 * std::size_t(model.n_parts), 0.0);
  return state;
}

ElementStep::ElementStep(const ElementModel& model, StepScheme scheme, double duration)
    : duration_(duration), law_(law_steps(model, scheme, duration)), stiffness_(stiffnesses(law_)),
      solver_(model.macro, model.pins, stiffness_), loads_(strain_loads(model.macro, stiffness_)),
      moves_(-solver_.solve(loads_))
{
  macro_stiffness_ =
      (affine_energy(model.macro, stiffness_) + loads_.transpose() * moves_) / model.macro.volume;
}

ElementState ElementStep::advance(const ElementModel& model, const ElementState& state,
                                  const MacroLoad& load) const
{
  const MacroNetwork& macro = model.macro;
  const int n_parts = model.n_parts;
  // forces if nothing moved, and what holds the particles under them
  Eigen::MatrixXd held = Eigen::MatrixXd::Zero(macro.n_dofs(), 1);
  Vec6 work = Vec6::Zero();
  for (std::size_t b = 0; b < macro.bonds.size(); ++b) {
    const Vec6 force = (law_[macro.law[b]].carry.row(0) * memory_of(state, b, n_parts)).transpose();
    add_end_forces(macro, b, macro.bonds[b].motion.transpose() * force, held);
    work += macro.bonds[b].strain.transpose() * force;
  }
  const Eigen::MatrixXd settled = -solver_.solve_once(held);
  const Vec6 stress_left = (work + loads_.transpose() * settled) / macro.volume;
  MacroLoad change = load;
  for (int k = 0; k < 6; ++k)
    if (!load.by_stress[k])
      change.value[k] -= state.strain[k];
  const MacroResponse response = mixed_response(macro_stiffness_, change, stress_left);

  ElementState next{state.time + duration_,
                    state.strain + response.strain,
                    response.stress,
                    {},
                    std::vector<double>(state.memory.size())};
  const Eigen::MatrixXd moved = settled + moves_ * response.strain;
  next.dofs = state.dofs + moved.col(0);
  for (std::size_t b = 0; b < macro.bonds.size(); ++b) {
    const BondModes& modes = macro.bonds[b];
    const Vec6 deformation =
        modes.motion * end_motion(macro, b, moved) + modes.strain * response.strain;
    const LawStep& law = law_[macro.law[b]];
    Memory(next.memory.data() + b * 6 * std::size_t(n_parts), n_parts, 6) =
        law.carry * memory_of(state, b, n_parts) +
        law.gain * modes.weight.cwiseProduct(deformation).transpose();
  }
  return next;
}

std::vector<ElementState> follow(const ElementModel& model, const ElementState& start,
                                 std::span<const MacroPoint> points, StepScheme scheme)
{
  StepStore store(model);
  std::vector<ElementState> states;
  double last = start.time, length = 0;
  for (const MacroPoint& point : points) {
    if (!(point.time >= last) || !std::isfinite(point.time))
      throw std::invalid_argument(fmt::format(
          "volume element: times must not decrease, found {:g} s after {:g} s", point.time, last));
    if (const double now = point.time - last; std::abs(now - length) > 1e-9 * length)
      length = now; // equal but for round-off: the same step
    const ElementState& before = states.empty() ? start : states.back();
    states.push_back(store.step(scheme, length).advance(model, before, point.load));
    states.back().time = last = point.time;
  }
  return states;
}

CreepHistory creep_compliance(const ElementModel& model, std::span<const double> times,
                              double tolerance)
{
  constexpr int most_steps = 1 << 14;
  constexpr auto scheme = StepScheme::force_linear;
  validate(times, tolerance);
  StepStore store(model);
  CreepTests tests(6, virgin_state(model));
  tests = crept(model, std::move(tests), store.step(scheme, 0), 1);
  CreepHistory history;
  int n = 1; // steps of the coarser of two solutions of an interval
  double now = 0;
  for (const double time : times) {
    double error = 0;
    if (const double interval = time - now; interval > 0) {
      const auto solution = [&](int n_steps) {
        history.n_steps += 6 * n_steps;
        return crept(model, tests, store.step(scheme, interval / n_steps), n_steps);
      };
      n = std::max(1, n / 2);
      CreepTests coarse = solution(n), fine = solution(2 * n);
      const auto difference = [&] {
        return (strains(fine) - strains(coarse)).norm() / strains(fine).norm() / 3;
      };
      while ((error = difference()) > tolerance) {
        n *= 2;
        if (n > most_steps)
          throw std::runtime_error(fmt::format(
              "creep: {} steps to {:g} s do not meet the tolerance {:g}", n, time, tolerance));
        coarse = std::move(fine);
        fine = solution(2 * n);
      }
      tests = std::move(fine);
      now = time;
    }
    history.time.push_back(time);
    history.compliance.push_back(strains(tests));
    history.error.push_back(error);
  }
  history.n_factorisations = store.n_factorisations();
  return history;
}

} // namespace dem
