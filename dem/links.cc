#include "dem/links.h"

#include "dem/contact_search.h"

#include <algorithm>
#include <limits>
#include <tuple>

namespace dem {

namespace {

BondFrame any_frame(const Vec3& normal)
{
  int smallest = 0;
  normal.cwiseAbs().minCoeff(&smallest);
  return {normal, normal.cross(Vec3::Unit(smallest)).normalized()};
}

int law_between(const Assembly& assembly, int a, int b)
{
  for (const PairLaw& each : assembly.pair_laws)
    if (std::minmax(each.class_a, each.class_b) == std::minmax(a, b))
      return each.law;
  return 0;
}

/// Two bodies that may touch: the first has the smaller number.
struct Pair {
  Index first, second;
  ImageShift image = ImageShift::Zero(); ///< of the second

  auto key() const { return std::tuple(first, second, image[0], image[1], image[2]); }
  bool operator<(const Pair& other) const { return key() < other.key(); }
};

Pair pair_of(const Link& link)
{
  if (link.first <= link.second)
    return {link.first, link.second, link.image};
  return {link.second, link.first, -link.image};
}

Link open_contact(const Pair& pair, const Assembly& assembly, const Bodies& bodies,
                  std::span<const Vec3> centre, const Mat3& stretch)
{
  Link link{};
  const auto [first, second, image] = pair;
  link.first = first;
  link.second = second;
  link.image = image;
  link.bond = -1;
  const bool platen = second >= bodies.n_particles();
  const int own = bodies.material_class[first];
  link.law = law_between(assembly, own, platen ? own : bodies.material_class[second]);
  const Vec3 r = branch(link, bodies, centre, stretch);
  link.distance = link.span = r.norm();
  link.touch = std::min(link.distance, bodies.radius[first] + (platen ? 0 : bodies.radius[second]));
  link.offset = platen ? 0.5 * link.distance : 0.5 * (bodies.radius[first] - bodies.radius[second]);
  link.frame = any_frame(r / link.distance);
  return link;
}

/// Pairs of spheres and images of spheres; a sphere and its own image is none.
std::vector<Pair> near_images(const Bodies& bodies, std::span<const Vec3> centre, double skin,
                              const Mat3& stretch)
{
  const Index n = bodies.n_particles();
  const PeriodicNeighbours near = periodic_near_pairs(
      {stretch * bodies.cell->edges}, centre.first(n), std::span(bodies.radius).first(n), skin);
  std::vector<Pair> pairs;
  for (Index i = 0; i < n; ++i)
    for (Index k = near.list.start[i]; k < near.list.start[i + 1]; ++k)
      if (near.list.neighbour[k] != i)
        pairs.push_back({i, near.list.neighbour[k], near.shift[k]});
  return pairs;
}

std::vector<Pair> near_bodies(const Bodies& bodies, std::span<const Vec3> centre, double skin)
{
  const Index n = bodies.n_particles();
  const NeighbourList near = near_pairs(centre.first(n), std::span(bodies.radius).first(n), skin);
  std::vector<Pair> pairs;
  for (Index i = 0; i < n; ++i) {
    for (Index k = near.start[i]; k < near.start[i + 1]; ++k)
      pairs.push_back({std::min(i, near.neighbour[k]), std::max(i, near.neighbour[k])});
    if (!bodies.platens_press || bodies.support[i] != Support::free)
      continue;
    const double below = centre[i].z() - bodies.radius[i] - centre[bodies.lower_platen()].z();
    const double above = centre[bodies.upper_platen()].z() - centre[i].z() - bodies.radius[i];
    if (below < skin)
      pairs.push_back({i, bodies.lower_platen()});
    if (above < skin)
      pairs.push_back({i, bodies.upper_platen()});
  }
  return pairs;
}

} // namespace

Bodies make_bodies(const Assembly& assembly)
{
  Bodies bodies{assembly.particles.radius, assembly.support, assembly.particles.material_class,
                loaded_by_platen(assembly)};
  bodies.radius.insert(bodies.radius.end(), 2, 0.0);
  bodies.support.insert(bodies.support.end(), {Support::bottom, Support::top});
  bodies.material_class.insert(bodies.material_class.end(), 2, 0);
  return bodies;
}

Vec3 branch(const Link& link, const Bodies& bodies, std::span<const Vec3> centre,
            const Mat3& stretch)
{
  const Vec3 r = centre[link.second] - centre[link.first];
  if (bodies.cell)
    return r + stretch * bodies.cell->translation(link.image);
  return link.second >= bodies.n_particles() ? Vec3(0, 0, r.z()) : r;
}

std::array<double, 6> mode_multipliers(const Link& link, const Assembly& assembly)
{
  const double shear = 1 / assembly.laws[link.law].normal_to_shear;
  if (link.kind == LinkKind::contact)
    return {1, shear, shear, 0, 0, 0};
  const double squared =
      assembly.bonds.section_radius[link.bond] * assembly.bonds.section_radius[link.bond];
  return {1, shear, shear, shear * squared / 2, squared / 4, squared / 4};
}

Links make_links(const Assembly& assembly, const Bodies& bodies, std::span<const Vec3> centre,
                 std::span<const ImageShift> image)
{
  Links links;
  for (const BondLaw& law : assembly.laws)
    links.n_parts = std::max(links.n_parts, 1 + int(law.creep.branches.size()));
  for (std::size_t b = 0; b < assembly.bonds.size(); ++b) {
    Link link{};
    link.first = assembly.bonds.ends[b][0];
    link.second = assembly.bonds.ends[b][1];
    link.bond = Index(b);
    link.law = assembly.bonds.law[b];
    link.kind = LinkKind::bond;
    link.closed = true;
    link.offset = assembly.bonds.contact_offset[b];
    if (!image.empty())
      link.image = image[b];
    const Vec3 r = branch(link, bodies, centre);
    link.touch = link.distance = link.span = r.norm();
    link.frame = any_frame(r / link.distance);
    links.link.push_back(link);
  }
  links.memory.assign(links.link.size() * 6 * links.n_parts, 0.0);
  links.reference.assign(centre.begin(), centre.end());
  return links;
}

Links find_contacts(Links links, const Assembly& assembly, const Bodies& bodies,
                    std::span<const Vec3> centre, double skin, const Mat3& stretch)
{
  Links result;
  result.n_parts = links.n_parts;
  const std::size_t stride = 6 * std::size_t(links.n_parts);
  std::vector<Pair> linked;
  const auto keep = [&](std::size_t k) {
    linked.push_back(pair_of(links.link[k]));
    result.link.push_back(links.link[k]);
    result.memory.insert(result.memory.end(), links.memory_of(k), links.memory_of(k) + stride);
  };
  for (std::size_t k = 0; k < links.link.size(); ++k) {
    const Link& link = links.link[k];
    if (link.bond >= 0 || link.closed ||
        branch(link, bodies, centre, stretch).norm() - link.touch < skin)
      keep(k);
  }
  std::sort(linked.begin(), linked.end());
  std::vector<Pair> near =
      bodies.cell ? near_images(bodies, centre, skin, stretch) : near_bodies(bodies, centre, skin);
  std::sort(near.begin(), near.end());
  for (const Pair& pair : near) {
    const Support support = bodies.support[pair.first];
    const bool both_held = support != Support::free && support == bodies.support[pair.second];
    if (both_held || std::binary_search(linked.begin(), linked.end(), pair))
      continue;
    result.link.push_back(open_contact(pair, assembly, bodies, centre, stretch));
    result.memory.insert(result.memory.end(), stride, 0.0);
  }
  // Contacts by their bodies, so that the order does not depend on when they were found.
  const std::size_t n_bonds = assembly.bonds.size();
  std::vector<std::size_t> order(result.link.size());
  for (std::size_t k = 0; k < order.size(); ++k)
    order[k] = k;
  std::sort(order.begin() + std::ptrdiff_t(n_bonds), order.end(),
            [&](std::size_t a, std::size_t b) {
              return pair_of(result.link[a]) < pair_of(result.link[b]);
            });
  Links sorted;
  sorted.n_parts = result.n_parts;
  for (const std::size_t k : order) {
    sorted.link.push_back(result.link[k]);
    sorted.memory.insert(sorted.memory.end(), result.memory_of(k), result.memory_of(k) + stride);
  }
  sorted.reference.assign(centre.begin(), centre.end());
  return sorted;
}

bool contacts_outdated(const Links& links, std::span<const Vec3> centre, double skin)
{
  double moved = 0;
  for (std::size_t i = 0; i < links.reference.size(); ++i)
    moved = std::max(moved, (centre[i] - links.reference[i]).squaredNorm());
  return 16 * moved > skin * skin; // half the skin is left for the next step
}

void open_link(Links& links, std::size_t k, double distance)
{
  links.link[k].closed = false;
  links.link[k].touch = distance;
  std::fill_n(links.memory_of(k), 6 * links.n_parts, 0.0);
}

void break_link(Links& links, std::size_t k, BreakMode mode, AfterBreakage after,
                double initial_distance)
{
  Link& link = links.link[k];
  link.kind = LinkKind::contact;
  if (after == AfterBreakage::leave) {
    open_link(links, k, -std::numeric_limits<double>::infinity()); // never closes again
    return;
  }
  double* memory = links.memory_of(k);
  if (mode == BreakMode::shear && memory[0] < 0) {
    const int kept = after == AfterBreakage::friction ? 3 : 1;
    std::fill_n(memory + kept * links.n_parts, (6 - kept) * links.n_parts, 0.0);
    link.touch = link.distance;
  } else
    open_link(links, k, std::min(initial_distance, link.distance));
}

} // namespace dem
