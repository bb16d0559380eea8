#include "dem/dynamic_contacts.h"

#include "dem/contact_search.h"

#include <algorithm>
#include <tuple>

namespace dem {

namespace {

Vec3 centre(const ContactSurroundings& around, Index slot)
{
  return Eigen::Map<const Vec3>(around.motions.data() + std::size_t(slot) * motion_stride);
}

Vec3 half_tangent_of(const ContactSurroundings& around, Index slot)
{
  return Eigen::Map<const Vec3>(around.motions.data() + std::size_t(slot) * motion_stride + 3);
}

/// Vector from the first sphere to its partner; to a platen along its normal.
Vec3 branch(const ContactSurroundings& around, const FrictionContact& contact)
{
  const Vec3 here = centre(around, contact.first);
  if (contact.second == lower_platen)
    return Vec3(0, 0, around.lower_height - here.z());
  if (contact.second == upper_platen)
    return Vec3(0, 0, around.upper_height - here.z());
  return centre(around, contact.second) - here;
}

double touching_distance(const ContactSurroundings& around, Index first, Index second)
{
  return around.radius[first] + (second >= 0 ? around.radius[second] : 0);
}

BondFrame any_frame(const Vec3& normal)
{
  int smallest = 0;
  normal.cwiseAbs().minCoeff(&smallest);
  return {normal, normal.cross(Vec3::Unit(smallest)).normalized()};
}

FrictionContact open_contact(const ContactSurroundings& around, Index first, Index second,
                             std::span<const PairLaw> pair_laws, int n_modes)
{
  FrictionContact contact;
  contact.first = first;
  contact.second = second;
  contact.law = 0;
  const int a = around.material_class[first];
  const int b = second >= 0 ? around.material_class[second] : a;
  for (const PairLaw& each : pair_laws)
    if (std::minmax(each.class_a, each.class_b) == std::minmax(a, b))
      contact.law = each.law;
  const Vec3 r = branch(around, contact);
  contact.distance = r.norm();
  contact.touch = std::min(contact.distance, touching_distance(around, first, second));
  contact.frame = any_frame(r / contact.distance);
  contact.normal.assign(n_modes, 0.0);
  contact.shear_1 = contact.shear_2 = contact.normal;
  return contact;
}

bool by_slots(const FrictionContact& a, const FrictionContact& b)
{
  return std::tie(a.first, a.second) < std::tie(b.first, b.second);
}

/// Pairs of slots within the skin, and slots near a platen they are not glued to.
std::vector<std::array<Index, 2>> candidates(const ContactSurroundings& around, double skin)
{
  const std::size_t n = around.radius.size();
  std::vector<Vec3> centres(n);
  for (std::size_t s = 0; s < n; ++s)
    centres[s] = centre(around, Index(s));
  const NeighbourList near = near_pairs(centres, around.radius, skin);
  std::vector<std::array<Index, 2>> pairs;
  for (std::size_t s = 0; s < n; ++s) {
    for (Index k = near.start[s]; k < near.start[s + 1]; ++k)
      pairs.push_back(
          {std::min(Index(s), near.neighbour[k]), std::max(Index(s), near.neighbour[k])});
    if (!around.platens_press || around.support[s] != Support::free)
      continue;
    if (centres[s].z() - around.radius[s] - around.lower_height < skin)
      pairs.push_back({Index(s), lower_platen});
    if (around.upper_height - centres[s].z() - around.radius[s] < skin)
      pairs.push_back({Index(s), upper_platen});
  }
  std::ranges::sort(pairs);
  return pairs;
}

void add_modes(std::vector<double>& modes, const StepFactors& factors, double push)
{
  for (std::size_t i = 0; i < modes.size(); ++i)
    modes[i] = factors.decay[i] * modes[i] + factors.gain[i] * push;
}

double sum(const std::vector<double>& modes)
{
  double result = 0;
  for (const double part : modes)
    result += part;
  return result;
}

void open(FrictionContact& contact, double distance)
{
  contact.closed = false;
  contact.touch = distance;
  std::ranges::fill(contact.normal, 0.0);
  std::ranges::fill(contact.shear_1, 0.0);
  std::ranges::fill(contact.shear_2, 0.0);
}

/// Slides until the shear force is within Coulomb's limit.
void slide(FrictionContact& contact, double limit)
{
  const double s1 = sum(contact.shear_1), s2 = sum(contact.shear_2);
  const double shear = std::sqrt(s1 * s1 + s2 * s2);
  if (shear <= limit)
    return;
  for (std::vector<double>* modes : {&contact.shear_1, &contact.shear_2})
    for (double& part : *modes)
      part *= limit / shear;
}

} // namespace

DynamicContacts find_contacts(DynamicContacts contacts, const ContactSurroundings& around,
                              std::span<const std::array<Index, 2>> bonded,
                              std::span<const PairLaw> pair_laws, int n_modes)
{
  std::vector<FrictionContact> kept;
  for (FrictionContact& contact : contacts.contacts)
    if (contact.closed || contact.bond >= 0 ||
        branch(around, contact).norm() - contact.touch < contacts.skin)
      kept.push_back(std::move(contact));
  std::ranges::sort(kept, by_slots);
  const std::size_t n_kept = kept.size();
  for (const auto& [first, second] : candidates(around, contacts.skin)) {
    FrictionContact fresh = open_contact(around, first, second, pair_laws, n_modes);
    if (!std::ranges::binary_search(bonded, std::array{first, second}) &&
        !std::binary_search(kept.begin(), kept.begin() + std::ptrdiff_t(n_kept), fresh, by_slots))
      kept.push_back(std::move(fresh));
  }
  std::ranges::sort(kept, by_slots);
  contacts.contacts = std::move(kept);
  contacts.reference.resize(around.radius.size());
  for (std::size_t s = 0; s < contacts.reference.size(); ++s)
    contacts.reference[s] = centre(around, Index(s));
  return contacts;
}

bool is_outdated(const DynamicContacts& contacts, const ContactSurroundings& around)
{
  double moved = 0;
  for (std::size_t s = 0; s < contacts.reference.size(); ++s)
    moved = std::max(moved, (centre(around, Index(s)) - contacts.reference[s]).squaredNorm());
  return 16 * moved > contacts.skin * contacts.skin; // half the skin is left for the next steps
}

FrictionContact contact_after(const DynamicBond& bond, BreakMode mode, double initial_distance)
{
  FrictionContact contact;
  contact.first = bond.first_slot;
  contact.second = bond.second_slot;
  contact.bond = bond.bond;
  contact.law = bond.law;
  contact.distance = bond.distance;
  contact.frame = {bond.normal, bond.tangent};
  const auto modes = [&](int component) {
    std::vector<double> result(bond.modes.cols());
    for (Eigen::Index i = 0; i < bond.modes.cols(); ++i)
      result[i] = bond.modes(component, i);
    return result;
  };
  contact.normal = modes(0);
  contact.shear_1 = modes(1);
  contact.shear_2 = modes(2);
  contact.closed = mode == BreakMode::shear && sum(contact.normal) < 0;
  if (contact.closed)
    contact.touch = bond.distance;
  else
    open(contact, std::min(initial_distance, bond.distance));
  if (contact.first > contact.second) { // lower slot first, as everywhere: the force turns round
    std::swap(contact.first, contact.second);
    contact.frame.normal = -contact.frame.normal;
    for (double& part : contact.shear_1)
      part = -part;
  }
  return contact;
}

void advance_contacts(DynamicContacts& contacts, const ContactSurroundings& around,
                      std::span<const BondLaw> laws, std::span<const StepFactors> factors,
                      double friction, double* forces, double& on_upper, double& on_lower)
{
  for (FrictionContact& contact : contacts.contacts) {
    const Vec3 now = branch(around, contact);
    const double distance = now.norm();
    if (!contact.closed && distance >= contact.touch) {
      contact.distance = distance;
      continue;
    }
    const Vec3 before = contact.distance * contact.frame.normal;
    const Vec3 normal = now / distance;
    const bool platen = contact.second < 0;
    const Vec3 h_first = half_tangent_of(around, contact.first);
    const Vec3 h_second = platen ? Vec3(Vec3::Zero()) : half_tangent_of(around, contact.second);
    const double arm_first =
        platen ? distance
               : 0.5 * (distance + around.radius[contact.first] - around.radius[contact.second]);
    const double share = arm_first / distance; // of the distance that belongs to the first
    const double from = contact.closed ? contact.distance : contact.touch;
    const Vec3 slip = platen ? Vec3(Vec3::Zero()) : Vec3(now - before);
    const Vec3 delta = slip - (share * h_first + (1 - share) * h_second).cross(now + before);
    contact.frame = carried(contact.frame, 0.5 * (h_first + h_second), normal);
    const BondLaw& law = laws[contact.law];
    const double k = law.creep.maxwell_stiffness, ks = k / law.normal_to_shear;
    add_modes(contact.normal, factors[contact.law], k * (distance - from));
    add_modes(contact.shear_1, factors[contact.law], ks * delta.dot(contact.frame.tangent));
    add_modes(contact.shear_2, factors[contact.law],
              ks * delta.dot(contact.frame.second_tangent()));
    contact.closed = true;
    contact.distance = distance;
    const double normal_force = sum(contact.normal);
    if (normal_force >= 0) {
      open(contact, distance);
      continue;
    }
    slide(contact, platen ? 0 : -friction * normal_force);
    const Vec3 force = normal_force * normal + sum(contact.shear_1) * contact.frame.tangent +
                       sum(contact.shear_2) * contact.frame.second_tangent();
    Eigen::Map<Vec3>(forces + std::size_t(contact.first) * force_stride) += force;
    Eigen::Map<Vec3>(forces + std::size_t(contact.first) * force_stride + 3) +=
        arm_first * normal.cross(force);
    if (!platen) {
      Eigen::Map<Vec3>(forces + std::size_t(contact.second) * force_stride) -= force;
      Eigen::Map<Vec3>(forces + std::size_t(contact.second) * force_stride + 3) +=
          (distance - arm_first) * normal.cross(force);
    } else
      (contact.second == upper_platen ? on_upper : on_lower) -= force.z();
  }
}

} // namespace dem
