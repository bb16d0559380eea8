#include "dem/storage.h"

#include <algorithm>
#include <stdexcept>

namespace dem {

namespace {

template <typename T, typename Container, typename Function>
std::vector<T> column(const Container& rows, Function&& value)
{
  std::vector<T> result;
  result.reserve(rows.size());
  for (const auto& row : rows)
    result.push_back(T(value(row)));
  return result;
}

std::vector<double> flat(const std::vector<Vec3>& vectors)
{
  std::vector<double> result;
  for (const Vec3& v : vectors)
    result.insert(result.end(), {v.x(), v.y(), v.z()});
  return result;
}

std::vector<Vec3> vectors(const std::vector<double>& numbers)
{
  std::vector<Vec3> result;
  for (std::size_t k = 0; k + 2 < numbers.size(); k += 3)
    result.emplace_back(numbers[k], numbers[k + 1], numbers[k + 2]);
  return result;
}

std::span<const double> span_of(const Eigen::VectorXd& vector)
{
  return {vector.data(), std::size_t(vector.size())};
}

Eigen::VectorXd eigen(const std::vector<double>& numbers)
{
  return Eigen::Map<const Eigen::VectorXd>(numbers.data(), Eigen::Index(numbers.size()));
}

std::vector<std::uint8_t> bytes(const std::vector<BondStatus>& status)
{
  return column<std::uint8_t>(status, [](BondStatus s) { return s; });
}

std::vector<BondStatus> statuses(const std::vector<std::uint8_t>& stored)
{
  return column<BondStatus>(stored, [](std::uint8_t s) { return s; });
}

/// Segments as rows of numbers; the two kinds never mix in one run.
std::vector<double> segment_row(const LoadSegment& segment)
{
  if (const auto* f = std::get_if<ForceSegment>(&segment)) {
    std::vector<double> row{f->start, f->load,          f->load_rate,    f->compliance,
                            f->jumps, f->state.elastic, f->state.viscous};
    row.insert(row.end(), f->state.kelvin.begin(), f->state.kelvin.end());
    return row;
  }
  const auto& d = std::get<DisplacementSegment>(segment);
  std::vector<double> row{d.start, d.displacement, d.rate, d.viscous, d.jumps};
  row.insert(row.end(), d.modes.begin(), d.modes.end());
  return row;
}

LoadSegment segment_from(std::span<const double> row, bool by_force)
{
  if (by_force)
    return ForceSegment{
        row[0], row[1], row[2], row[3], {row[5], row[6], {row.begin() + 7, row.end()}}, row[4]};
  return DisplacementSegment{row[0], row[1], row[2], {row.begin() + 5, row.end()}, row[3], row[4]};
}

void write_damage(Hdf5File& file, const std::string& group, const Damage& damage)
{
  file.write(group + "/status", bytes(damage.status));
  file.write(group + "/factorised", bytes(damage.factorised));
  std::vector<std::int32_t> first{0}, bond;
  std::vector<std::uint8_t> status;
  for (const std::vector<BondChange>& changes : damage.updates) {
    for (const BondChange& change : changes) {
      bond.push_back(change.bond);
      status.push_back(std::uint8_t(change.status));
    }
    first.push_back(std::int32_t(bond.size()));
  }
  file.write(group + "/update_first", first);
  file.write(group + "/update_bond", bond);
  file.write(group + "/update_status", status);
}

Damage read_damage(const Hdf5File& file, const std::string& group)
{
  Damage damage{statuses(file.read_bytes(group + "/status")),
                statuses(file.read_bytes(group + "/factorised")),
                {}};
  const auto first = file.read_integers(group + "/update_first");
  const auto bond = file.read_integers(group + "/update_bond");
  const auto status = file.read_bytes(group + "/update_status");
  for (std::size_t u = 0; u + 1 < first.size(); ++u) {
    std::vector<BondChange> changes;
    for (std::int32_t k = first[u]; k < first[u + 1]; ++k)
      changes.push_back({bond[k], BondStatus(status[k])});
    damage.updates.push_back(std::move(changes));
  }
  return damage;
}

void require_size(std::size_t found, std::size_t expected, const char* what)
{
  if (found != expected)
    throw std::runtime_error(std::string("the checkpoint does not belong to this scene: it has "
                                         "another number of ") +
                             what);
}

} // namespace

void write_particles(Hdf5File& file, const std::string& group, const Particles& particles)
{
  file.write(group + "/centre", flat(particles.centre), "m", 3);
  file.write(group + "/radius", particles.radius, "m");
  file.write(group + "/material_class",
             column<std::int32_t>(particles.material_class, [](int c) { return c; }));
  file.set_attribute(group, "density_kg_per_m3", particles.density);
}

Particles read_particles(const Hdf5File& file, const std::string& group)
{
  Particles particles{vectors(file.read_doubles(group + "/centre")),
                      file.read_doubles(group + "/radius"),
                      {},
                      file.number_attribute(group, "density_kg_per_m3")};
  particles.material_class =
      column<int>(file.read_integers(group + "/material_class"), [](std::int32_t c) { return c; });
  require_size(particles.centre.size(), particles.radius.size(), "centres and radii");
  return particles;
}

void write_bonds(Hdf5File& file, const std::string& group, const Assembly& assembly)
{
  std::vector<std::int32_t> ends;
  for (const auto& [a, b] : assembly.bonds.ends)
    ends.insert(ends.end(), {a, b});
  file.write(group + "/particles", ends, 2);
  file.write(group + "/section_radius", assembly.bonds.section_radius, "m");
  file.write(group + "/law", column<std::int32_t>(assembly.bonds.law, [](int l) { return l; }));
  file.write(group + "/id", assembly.bonds.id);
  if (assembly.strengths) {
    file.write(group + "/normal_strength", assembly.strengths->normal, "N");
    file.write(group + "/shear_strength", assembly.strengths->shear, "N");
  }
}

void write_breakages(Hdf5File& file, const std::string& group,
                     const std::vector<Breakage>& breakages)
{
  const auto doubles = [&](const char* name, const char* unit, auto member) {
    file.write(group + "/" + name,
               column<double>(breakages, [&](const Breakage& b) { return b.*member; }), unit);
  };
  doubles("time", "s", &Breakage::time);
  doubles("normal_force", "N", &Breakage::normal_force);
  doubles("shear_force", "N", &Breakage::shear_force);
  doubles("strength_factor", "1", &Breakage::strength_factor);
  doubles("strain", "1", &Breakage::strain);
  file.write(group + "/bond",
             column<std::int32_t>(breakages, [](const Breakage& b) { return b.bond; }));
  file.write(group + "/mode",
             column<std::uint8_t>(breakages, [](const Breakage& b) { return b.mode; }));
  file.write(group + "/pass",
             column<std::int32_t>(breakages, [](const Breakage& b) { return b.pass; }));
  file.set_attribute(group, "mode", "0 tension, 1 shear");
  file.set_attribute(group, "sign", "tension positive");
}

std::vector<Breakage> read_breakages(const Hdf5File& file, const std::string& group)
{
  const auto time = file.read_doubles(group + "/time");
  const auto normal = file.read_doubles(group + "/normal_force");
  const auto shear = file.read_doubles(group + "/shear_force");
  const auto factor = file.read_doubles(group + "/strength_factor");
  const auto strain = file.read_doubles(group + "/strain");
  const auto bond = file.read_integers(group + "/bond");
  const auto mode = file.read_bytes(group + "/mode");
  const auto pass = file.read_integers(group + "/pass");
  std::vector<Breakage> breakages;
  for (std::size_t k = 0; k < time.size(); ++k)
    breakages.push_back(
        {time[k], bond[k], BreakMode(mode[k]), normal[k], shear[k], factor[k], strain[k], pass[k]});
  return breakages;
}

void write_state(Hdf5File& file, const std::string& group, const EventsState& state)
{
  std::vector<double> segments;
  int columns = 1;
  for (const LoadSegment& segment : state.history.segments) {
    const std::vector<double> row = segment_row(segment);
    columns = int(row.size());
    segments.insert(segments.end(), row.begin(), row.end());
  }
  file.write(group + "/segments", segments, "SI", columns);
  file.set_attribute(group, "segment_columns", columns);
  file.set_attribute(group, "by_force",
                     std::holds_alternative<ForceSegment>(state.history.segments.front()));
  file.set_attribute(group, "segment_end", state.segment_end);
  write_damage(file, group + "/damage", state.damage);
  file.write(group + "/viscous", span_of(state.viscous), "m");
  for (std::size_t k = 0; k < state.kelvin.size(); ++k)
    file.write(group + "/kelvin_" + std::to_string(k), span_of(state.kelvin[k]), "m");
  write_breakages(file, group + "/breakages", state.breakages);
  file.set_attribute(group, "n_opened", double(state.n_opened));
  file.set_attribute(group, "largest_ground_share", state.largest_ground_share);
  file.set_attribute(group, "end", double(state.end));
  file.set_attribute(group, "end_reason", state.end_reason);
}

EventsState read_events_state(const Hdf5File& file, const std::string& group,
                              const EventsModel& model)
{
  EventsState state;
  state.history = {model.creep, {}, model.gauge_length};
  const auto numbers = file.read_doubles(group + "/segments");
  const auto columns = std::size_t(file.number_attribute(group, "segment_columns"));
  const bool by_force = file.number_attribute(group, "by_force") != 0;
  for (std::size_t k = 0; k + columns <= numbers.size(); k += columns)
    state.history.segments.push_back(
        segment_from(std::span(numbers).subspan(k, columns), by_force));
  state.segment_end = file.number_attribute(group, "segment_end");
  state.damage = read_damage(file, group + "/damage");
  require_size(state.damage.status.size(), model.network.bonds.size(), "bonds");
  state.viscous = eigen(file.read_doubles(group + "/viscous"));
  require_size(std::size_t(state.viscous.size()), std::size_t(model.network.n_dofs), "particles");
  for (std::size_t k = 0; k < model.creep.law.branches.size(); ++k)
    state.kelvin.push_back(eigen(file.read_doubles(group + "/kelvin_" + std::to_string(k))));
  state.breakages = read_breakages(file, group + "/breakages");
  state.n_opened = long(file.number_attribute(group, "n_opened"));
  state.largest_ground_share = file.number_attribute(group, "largest_ground_share");
  state.end = RunEnd(int(file.number_attribute(group, "end")));
  state.end_reason = file.text_attribute(group, "end_reason");
  return state;
}

void write_state(Hdf5File& file, const std::string& group, const DynamicState& state)
{
  file.write(group + "/motions", state.motions, "SI", motion_stride);
  file.write(group + "/velocity", state.velocity, "SI", 6);
  file.write(group + "/rotation", flat(state.rotation), "rad", 3);
  file.write(group + "/bond_fields", state.bonds.fields, "SI");
  file.write(group + "/forces", state.forces, "SI", force_stride);
  file.write(group + "/samples", state.samples, "m");
  file.set_attribute(group, "n_steps", double(state.n_steps));
  file.set_attribute(group, "displacement", state.displacement);
  file.set_attribute(group, "servo_velocity", state.servo_velocity);
  file.set_attribute(group, "force_on_upper", state.force_on_upper);
  file.set_attribute(group, "force_on_lower", state.force_on_lower);
  file.set_attribute(group, "strength_factor", state.strength_factor);
  file.set_attribute(group, "end", double(state.end));
  write_breakages(file, group + "/breakages", state.breakages);

  const std::vector<FrictionContact>& contacts = state.contacts.contacts;
  std::vector<std::int32_t> numbers;
  std::vector<double> geometry, modes;
  for (const FrictionContact& c : contacts) {
    numbers.insert(numbers.end(), {c.first, c.second, c.bond, c.law, c.closed});
    geometry.insert(geometry.end(), {c.touch, c.distance});
    for (const Vec3& v : {c.frame.normal, c.frame.tangent})
      geometry.insert(geometry.end(), {v.x(), v.y(), v.z()});
    for (const std::vector<double>* part : {&c.normal, &c.shear_1, &c.shear_2})
      modes.insert(modes.end(), part->begin(), part->end());
  }
  file.write(group + "/contact_numbers", numbers, 5);
  file.write(group + "/contact_geometry", geometry, "SI", 8);
  file.write(group + "/contact_modes", modes, "N");
  file.write(group + "/contact_reference", flat(state.contacts.reference), "m", 3);
  file.set_attribute(group, "contact_skin", state.contacts.skin);
}

DynamicState read_dynamic_state(const Hdf5File& file, const std::string& group,
                                const DynamicModel& model)
{
  DynamicState state = start(model);
  const auto aligned = [&](const char* name, std::size_t expected, const char* what) {
    const std::vector<double> numbers = file.read_doubles(group + "/" + name);
    require_size(numbers.size(), expected, what);
    return AlignedDoubles(numbers.begin(), numbers.end());
  };
  state.motions = aligned("motions", state.motions.size(), "particles");
  state.velocity = file.read_doubles(group + "/velocity");
  state.rotation = vectors(file.read_doubles(group + "/rotation"));
  state.bonds.fields = aligned("bond_fields", state.bonds.fields.size(), "bonds");
  state.forces = aligned("forces", state.forces.size(), "particles");
  state.samples = file.read_doubles(group + "/samples");
  state.n_steps = long(file.number_attribute(group, "n_steps"));
  state.displacement = file.number_attribute(group, "displacement");
  state.servo_velocity = file.number_attribute(group, "servo_velocity");
  state.force_on_upper = file.number_attribute(group, "force_on_upper");
  state.force_on_lower = file.number_attribute(group, "force_on_lower");
  state.strength_factor = file.number_attribute(group, "strength_factor");
  state.end = RunEnd(int(file.number_attribute(group, "end")));
  state.breakages = read_breakages(file, group + "/breakages");

  const auto numbers = file.read_integers(group + "/contact_numbers");
  const auto geometry = file.read_doubles(group + "/contact_geometry");
  const auto modes = file.read_doubles(group + "/contact_modes");
  const auto n_modes = std::size_t(model.n_modes);
  state.contacts.contacts.clear();
  for (std::size_t k = 0; 5 * k < numbers.size(); ++k) {
    const std::int32_t* n = numbers.data() + 5 * k;
    const double* g = geometry.data() + 8 * k;
    const double* m = modes.data() + 3 * n_modes * k;
    state.contacts.contacts.push_back({n[0],
                                       n[1],
                                       n[2],
                                       n[3],
                                       g[0],
                                       g[1],
                                       {Vec3(g[2], g[3], g[4]), Vec3(g[5], g[6], g[7])},
                                       n[4] != 0,
                                       {m, m + n_modes},
                                       {m + n_modes, m + 2 * n_modes},
                                       {m + 2 * n_modes, m + 3 * n_modes}});
  }
  state.contacts.reference = vectors(file.read_doubles(group + "/contact_reference"));
  state.contacts.skin = file.number_attribute(group, "contact_skin");
  return state;
}

} // namespace dem
