#include "dem/volume_element.h"

#include <Eigen/LU>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <stdexcept>
#include <tuple>

namespace dem {

namespace {

/// Bonds that are no farther apart than a share of the smaller radius are ever made between the
/// nearest pairs.
constexpr double largest_nearest_gap = 0.05;

using Contact = std::tuple<double, Index, Index, std::array<int, 3>>; // gap, ends, shift

std::array<int, 3> numbers(const ImageShift& shift)
{
  return {shift[0], shift[1], shift[2]};
}

std::vector<Contact> candidates(const PeriodicCell& cell, const Particles& particles,
                                double largest_gap)
{
  std::vector<Contact> result;
  if (particles.size() == 0)
    return result;
  const auto& [centre, radius, material_class, density] = particles;
  const double margin = std::max(0.0, largest_gap) * std::ranges::max(radius);
  const auto [list, shift] = periodic_near_pairs(cell, centre, radius, margin * (1 + 1e-9));
  for (Index i = 0; i < Index(particles.size()); ++i)
    for (Index k = list.start[i]; k < list.start[i + 1]; ++k) {
      const Index j = list.neighbour[k];
      const double distance = (centre[j] + cell.translation(shift[k]) - centre[i]).norm();
      const double gap = (distance - radius[i] - radius[j]) / std::min(radius[i], radius[j]);
      if (gap <= largest_gap)
        result.emplace_back(gap, i, j, numbers(shift[k]));
    }
  return result;
}

PeriodicContacts sorted_contacts(std::vector<Contact> chosen)
{
  std::ranges::sort(chosen, {}, [](const Contact& c) {
    return std::tuple(std::get<1>(c), std::get<2>(c), std::get<3>(c));
  });
  PeriodicContacts result{{}, {}, -1};
  for (const auto& [gap, i, j, shift] : chosen) {
    result.pairs.push_back({i, j});
    result.shift.emplace_back(shift[0], shift[1], shift[2]);
    result.gap = std::max(result.gap, gap);
  }
  return result;
}

void validate(const Particles& particles)
{
  if (particles.centre.size() != particles.size() ||
      particles.material_class.size() != particles.size())
    throw std::invalid_argument(
        "volume element: centres, radii and classes of the particles must be equally many");
  for (std::size_t i = 0; i < particles.size(); ++i)
    if (!particles.centre[i].allFinite() || !(particles.radius[i] > 0) ||
        !std::isfinite(particles.radius[i]))
      throw std::invalid_argument(
          fmt::format("volume element: particle {} must have a finite centre and a radius > 0", i));
}

/// Refuses what is no bond.
class BondCheck {
public:
  BondCheck(const PeriodicCell& cell, const Particles& particles)
      : cell_(cell), particles_(particles)
  {
  }

  void accept(const std::array<Index, 2>& ends, const ImageShift& shift)
  {
    const auto [a, b] = ends;
    const auto n = Index(particles_.size());
    const auto refuse = [&](const std::string& what) {
      throw std::invalid_argument(
          fmt::format("bond {} between particles {} and {}, shift {} {} {}: {}", seen_.size(), a, b,
                      shift[0], shift[1], shift[2], what));
    };
    if (a < 0 || b < 0 || a >= n || b >= n)
      refuse(fmt::format("there are particles 0 to {} only", n - 1));
    if (a == b && shift.isZero())
      refuse("a particle can be bonded to its images, but not to itself");
    const ImageShift back = -shift;
    if (!seen_.insert(std::min(std::tuple(a, b, numbers(shift)), std::tuple(b, a, numbers(back))))
             .second)
      refuse("this pair is already bonded");
    const Vec3 between = particles_.centre[b] + cell_.translation(shift) - particles_.centre[a];
    if (!(between.norm() > 1e-9 * std::min(particles_.radius[a], particles_.radius[b])))
      refuse("the centres coincide, the bond has no direction");
  }

private:
  const PeriodicCell& cell_;
  const Particles& particles_;
  std::set<std::tuple<Index, Index, std::array<int, 3>>> seen_;
};

/// Particles of the box and their numbers there.
struct Selection {
  Particles particles;
  std::vector<Index> number; ///< of each particle of the packing, or -1
};

Selection selected(const Particles& packing, const std::vector<bool>& keep)
{
  Selection result{{{}, {}, {}, packing.density}, std::vector<Index>(packing.size(), -1)};
  for (std::size_t i = 0; i < packing.size(); ++i)
    if (keep[i]) {
      result.number[i] = Index(result.particles.size());
      result.particles.centre.push_back(packing.centre[i]);
      result.particles.radius.push_back(packing.radius[i]);
      result.particles.material_class.push_back(packing.material_class[i]);
    }
  return result;
}

VolumeElement bonded_selection(const Selection& selection,
                               std::span<const std::array<Index, 2>> contacts,
                               const PeriodicCell& cell, std::vector<BondLaw> laws,
                               std::vector<PairLaw> pair_laws)
{
  VolumeElement element{
      cell, selection.particles, std::move(laws), std::move(pair_laws), {}, {}, false, {}};
  std::vector<std::array<Index, 2>> pairs;
  for (const auto& [a, b] : contacts)
    if (selection.number.at(a) >= 0 && selection.number.at(b) >= 0)
      pairs.push_back({selection.number[a], selection.number[b]});
  element.bonds = make_bonds(element.particles, pairs, element.laws, element.pair_laws);
  element.shift.assign(pairs.size(), ImageShift::Zero());
  return element;
}

} // namespace

PeriodicContacts periodic_contacts_within(const PeriodicCell& cell, const Particles& particles,
                                          double gap)
{
  return sorted_contacts(candidates(cell, particles, gap));
}

PeriodicContacts periodic_nearest_contacts(const PeriodicCell& cell, const Particles& particles,
                                           double mean_contacts)
{
  std::vector<Contact> all = candidates(cell, particles, largest_nearest_gap);
  std::ranges::sort(all);
  const auto wanted = std::size_t(std::llround(0.5 * mean_contacts * double(particles.size())));
  all.resize(std::min(all.size(), wanted));
  return sorted_contacts(std::move(all));
}

VolumeElement make_volume_element(const PeriodicCell& cell, Particles particles,
                                  const PeriodicContacts& contacts, std::vector<BondLaw> laws,
                                  std::vector<PairLaw> pair_laws)
{
  validate(particles);
  validate(laws);
  for (const PairLaw& each : pair_laws)
    if (each.law < 0 || each.law >= std::ssize(laws))
      throw std::invalid_argument(fmt::format(
          "volume element: classes {} and {} are given law {}, there are laws 0 to {} only",
          each.class_a, each.class_b, each.law, std::ssize(laws) - 1));
  if (contacts.pairs.size() != contacts.shift.size())
    throw std::invalid_argument("volume element: each contact needs a shift");
  VolumeElement element{make_periodic_cell(cell.edges),
                        std::move(particles),
                        std::move(laws),
                        std::move(pair_laws),
                        {},
                        {},
                        true,
                        {}};
  BondCheck check(element.cell, element.particles);
  for (std::size_t b = 0; b < contacts.pairs.size(); ++b) {
    check.accept(contacts.pairs[b], contacts.shift[b]);
    append_bond(element.bonds, element.particles, contacts.pairs[b], element.laws,
                element.pair_laws);
  }
  std::vector<ImageShift> into;
  for (Vec3& centre : element.particles.centre) {
    into.push_back(shift_into_cell(element.cell, centre));
    centre += element.cell.translation(into.back());
  }
  for (std::size_t b = 0; b < contacts.pairs.size(); ++b) {
    const auto [i, j] = contacts.pairs[b];
    element.shift.push_back(contacts.shift[b] + into[i] - into[j]);
  }
  return element;
}

VolumeElement cut_box(const Particles& packing, std::span<const std::array<Index, 2>> contacts,
                      const Vec3& low, const Vec3& high, double layer, std::vector<BondLaw> laws,
                      std::vector<PairLaw> pair_laws)
{
  const PeriodicCell cell = box_cell(high - low);
  const auto inside = [&](const Vec3& x) {
    return (x - low).minCoeff() >= 0 && (high - x).minCoeff() >= 0;
  };
  std::vector<bool> keep;
  for (const Vec3& centre : packing.centre)
    keep.push_back(inside(centre));
  const VolumeElement all =
      bonded_selection(selected(packing, keep), contacts, cell, laws, pair_laws);
  const Clusters clusters =
      find_clusters(all, std::vector<BondStatus>(all.bonds.size(), BondStatus::intact));
  if (clusters.cluster.empty())
    throw std::invalid_argument("cut box: there are no particles in the box");
  const auto largest = std::ranges::max_element(
      clusters.cluster, {}, [](const Cluster& each) { return each.particles.size(); });
  std::vector<bool> is_kept(all.particles.size(), false);
  for (const Index i : largest->particles)
    is_kept[i] = true;
  VolumeElement element = bonded_selection(selected(all.particles, is_kept), all.bonds.ends, cell,
                                           std::move(laws), std::move(pair_laws));
  Eigen::Matrix<int, 3, 2> n_at_face = Eigen::Matrix<int, 3, 2>::Zero();
  for (std::size_t i = 0; i < element.particles.size(); ++i) {
    ImageShift side = ImageShift::Zero();
    for (int k = 0; k < 3; ++k) {
      const double x = element.particles.centre[i][k];
      const double below = x - low[k], above = high[k] - x;
      side[k] = std::min(below, above) > layer ? 0 : below < above ? -1 : 1;
      if (side[k] != 0)
        ++n_at_face(k, side[k] > 0);
    }
    if (!side.isZero())
      element.boundary.push_back({Index(i), side});
  }
  if (n_at_face.minCoeff() == 0)
    throw std::invalid_argument(
        "cut box: a face has no particles in its boundary layer; make the layer thicker");
  return element;
}

Vec3 branch(const VolumeElement& element, std::size_t bond)
{
  const auto [i, j] = element.bonds.ends[bond];
  const auto& centre = element.particles.centre;
  return centre[j] + element.cell.translation(element.shift[bond]) - centre[i];
}

double solid_fraction(const VolumeElement& element)
{
  double solid = 0;
  for (const double radius : element.particles.radius)
    solid += sphere_volume(radius);
  return solid / element.cell.volume();
}

ElasticNetwork make_network(const VolumeElement& element)
{
  ElasticNetwork network;
  for (std::size_t b = 0; b < element.bonds.size(); ++b) {
    const Vec3 between = branch(element, b);
    const double length = between.norm(), offset = element.bonds.contact_offset[b];
    const Vec3 normal = between / length;
    network.bonds.push_back(
        {element.bonds.ends[b], normal, (0.5 * length + offset) * normal,
         (offset - 0.5 * length) * normal,
         mode_stiffness(element.laws[element.bonds.law[b]], element.bonds.section_radius[b])});
  }
  const std::size_t n = element.particles.size();
  network.centre = element.particles.centre;
  network.radius = element.particles.radius;
  network.support.assign(n, Support::free);
  network.first_dof.resize(n);
  for (std::size_t i = 0; i < n; ++i)
    network.first_dof[i] = 6 * Index(i);
  network.n_dofs = 6 * Index(n);
  network.unit_load = Eigen::VectorXd::Zero(network.n_dofs);
  return network;
}

} // namespace dem
