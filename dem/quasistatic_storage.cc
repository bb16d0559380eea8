#include "dem/storage.h"

#include <cmath>
#include <limits>
#include <stdexcept>

namespace dem {

namespace {

std::vector<double> flat(const std::vector<Vec3>& vectors)
{
  std::vector<double> numbers;
  for (const Vec3& v : vectors)
    numbers.insert(numbers.end(), {v.x(), v.y(), v.z()});
  return numbers;
}

std::vector<Vec3> vectors(const std::vector<double>& numbers)
{
  std::vector<Vec3> result;
  for (std::size_t k = 0; k + 2 < numbers.size(); k += 3)
    result.emplace_back(numbers[k], numbers[k + 1], numbers[k + 2]);
  return result;
}

constexpr int path_columns = 12;
constexpr int link_integers = 6;
constexpr int link_numbers = 10;

void write_links(Hdf5File& file, const std::string& group, const Links& links)
{
  std::vector<std::int32_t> integers;
  std::vector<double> numbers;
  for (const Link& link : links.link) {
    integers.insert(integers.end(), {link.first, link.second, link.bond, link.law,
                                     std::int32_t(link.kind), std::int32_t(link.closed)});
    numbers.insert(numbers.end(), {link.offset, link.touch, link.distance, link.span});
    for (const Vec3& v : {link.frame.normal, link.frame.tangent})
      numbers.insert(numbers.end(), {v.x(), v.y(), v.z()});
  }
  file.write(group + "/integers", integers, link_integers);
  file.write(group + "/numbers", numbers, "SI", link_numbers);
  file.write(group + "/memory", links.memory, "SI");
  file.write(group + "/reference", flat(links.reference), "m", 3);
}

Links read_links(const Hdf5File& file, const std::string& group, const Links& at_start)
{
  Links links;
  links.n_parts = at_start.n_parts;
  const auto integers = file.read_integers(group + "/integers");
  const auto numbers = file.read_doubles(group + "/numbers");
  for (std::size_t k = 0; k * link_integers < integers.size(); ++k) {
    const std::int32_t* n = integers.data() + k * link_integers;
    const double* g = numbers.data() + k * link_numbers;
    links.link.push_back({n[0],
                          n[1],
                          n[2],
                          n[3],
                          LinkKind(n[4]),
                          n[5] != 0,
                          g[0],
                          g[1],
                          g[2],
                          g[3],
                          {Vec3(g[4], g[5], g[6]), Vec3(g[7], g[8], g[9])}});
  }
  links.memory = file.read_doubles(group + "/memory");
  links.reference = vectors(file.read_doubles(group + "/reference"));
  if (links.memory.size() != links.link.size() * 6 * links.n_parts)
    throw std::runtime_error("the stored state belongs to other bond laws");
  return links;
}

void write_path(Hdf5File& file, const std::string& name, const StrainPath& path)
{
  std::vector<double> rows;
  for (const PathPoint& p : path)
    rows.insert(rows.end(), {p.time, p.displacement, p.smooth, p.rate, p.force, double(p.n_broken),
                             p.energy.work, p.energy.stored, p.energy.dashpots, p.energy.friction,
                             p.energy.breakage, p.energy.regularisation});
  file.write(name, rows, "SI", path_columns);
}

StrainPath read_path(const Hdf5File& file, const std::string& name)
{
  const std::vector<double> rows = file.read_doubles(name);
  StrainPath path;
  for (std::size_t k = 0; k + path_columns <= rows.size(); k += path_columns) {
    const double* r = rows.data() + k;
    path.push_back(
        {r[0], r[1], r[2], r[3], r[4], long(r[5]), {r[6], r[7], r[8], r[9], r[10], r[11]}});
  }
  return path;
}

void write_wear(Hdf5File& file, const std::string& group, const StaleFactor::Wear& wear)
{
  std::vector<std::int32_t> ends;
  if (wear.factorised)
    for (const auto& [a, b] : wear.factorised->ends)
      ends.insert(ends.end(), {a, b});
  file.write(group + "/ends", ends, 2);
  file.write(group + "/values", wear.factorised ? wear.factorised->values : std::vector<double>{},
             "N/m");
  file.set_attribute(group, "stiffness", wear.factorised ? wear.factorised->stiffness : 0.0);
  file.set_attribute(group, "extra_iterations", double(wear.extra_iterations));
  file.set_attribute(group, "failures", double(wear.n_failures));
  file.set_attribute(group, "fresh", double(wear.n_fresh));
}

StaleFactor::Wear read_wear(const Hdf5File& file, const std::string& group)
{
  const auto ends = file.read_integers(group + "/ends");
  if (ends.empty())
    return {};
  auto factorised = std::make_shared<FactorisedMatrix>();
  for (std::size_t k = 0; k + 1 < ends.size(); k += 2)
    factorised->ends.push_back({ends[k], ends[k + 1]});
  factorised->values = file.read_doubles(group + "/values");
  factorised->stiffness = file.number_attribute(group, "stiffness");
  return {std::move(factorised), long(file.number_attribute(group, "extra_iterations")),
          long(file.number_attribute(group, "failures")),
          long(file.number_attribute(group, "fresh"))};
}

} // namespace

void write_state(Hdf5File& file, const std::string& group, const QuasistaticState& state)
{
  file.write(group + "/centre", flat(state.centre), "m", 3);
  file.write(group + "/rotation", flat(state.rotation), "rad", 3);
  file.write(group + "/velocity",
             std::span(state.velocity.data(), std::size_t(state.velocity.size())), "m/s");
  write_links(file, group + "/links", state.links);
  write_path(file, group + "/path", state.path);
  write_wear(file, group + "/factor", state.wear);
  write_breakages(file, group + "/breakages", state.breakages);
  file.set_attribute(group, "next_step", state.next_step);
  file.set_attribute(group, "settled", double(state.settled));
  file.set_attribute(group, "pass", double(state.pass));
  file.set_attribute(group, "n_steps", double(state.n_steps));
  file.set_attribute(group, "n_rejected", double(state.n_rejected));
  file.set_attribute(group, "n_passages", double(state.n_passages));
  file.set_attribute(group, "passages_in_a_row", double(state.passages_in_a_row));
  file.set_attribute(group, "passage_hold", state.passage_hold);
  file.set_attribute(group, "in_avalanche", double(state.in_avalanche));
  file.set_attribute(group, "passage_start_m",
                     state.passage_start.value_or(std::numeric_limits<double>::quiet_NaN()));
  file.set_attribute(group, "end", double(state.end));
  file.set_attribute(group, "end_reason", state.end_reason);
}

QuasistaticState read_quasistatic_state(const Hdf5File& file, const std::string& group,
                                        const QuasistaticModel& model)
{
  QuasistaticState state = start(model);
  const std::size_t n_bodies = state.centre.size();
  state.centre = vectors(file.read_doubles(group + "/centre"));
  if (state.centre.size() != n_bodies)
    throw std::runtime_error("the stored state belongs to another number of particles");
  state.rotation = vectors(file.read_doubles(group + "/rotation"));
  const std::vector<double> velocity = file.read_doubles(group + "/velocity");
  state.velocity =
      Eigen::Map<const Eigen::VectorXd>(velocity.data(), Eigen::Index(velocity.size()));
  state.links = read_links(file, group + "/links", state.links);
  state.path = read_path(file, group + "/path");
  state.wear = read_wear(file, group + "/factor");
  state.breakages = read_breakages(file, group + "/breakages");
  const auto number = [&](const char* name) { return file.number_attribute(group, name); };
  state.next_step = number("next_step");
  state.settled = number("settled") != 0;
  state.pass = int(number("pass"));
  state.n_steps = long(number("n_steps"));
  state.n_rejected = long(number("n_rejected"));
  state.n_passages = long(number("n_passages"));
  state.passages_in_a_row = int(number("passages_in_a_row"));
  state.passage_hold = number("passage_hold");
  state.in_avalanche = number("in_avalanche") != 0;
  if (const double from = number("passage_start_m"); !std::isnan(from))
    state.passage_start = from;
  state.end = RunEnd(int(number("end")));
  state.end_reason = file.text_attribute(group, "end_reason");
  return state;
}

} // namespace dem
