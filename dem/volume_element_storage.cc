#include "dem/volume_element_storage.h"

#include "dem/storage.h"

#include <limits>
#include <stdexcept>

namespace dem {

namespace {

std::vector<std::int32_t> flat(const std::vector<ImageShift>& shifts)
{
  std::vector<std::int32_t> result;
  for (const ImageShift& shift : shifts)
    result.insert(result.end(), {shift[0], shift[1], shift[2]});
  return result;
}

std::vector<ImageShift> shifts(const std::vector<std::int32_t>& numbers)
{
  std::vector<ImageShift> result;
  for (std::size_t k = 0; k + 2 < numbers.size(); k += 3)
    result.emplace_back(numbers[k], numbers[k + 1], numbers[k + 2]);
  return result;
}

void require(bool condition, const std::string& group, const char* what)
{
  if (!condition)
    throw std::runtime_error("volume element '" + group + "' of the file: " + what);
}

/// A law without a dashpot has an infinite viscosity in the file.
void write_laws(Hdf5File& file, const std::string& group, const std::vector<BondLaw>& laws)
{
  std::vector<double> stiffness, viscosity, ratio, multiplier, branch_stiffness, branch_viscosity;
  std::vector<std::int32_t> n_branches;
  for (const BondLaw& law : laws) {
    stiffness.push_back(law.creep.maxwell_stiffness);
    viscosity.push_back(
        law.creep.maxwell_viscosity.value_or(std::numeric_limits<double>::infinity()));
    ratio.push_back(law.normal_to_shear);
    multiplier.push_back(law.radius_multiplier);
    n_branches.push_back(std::int32_t(law.creep.branches.size()));
    for (const KelvinBranch& branch : law.creep.branches) {
      branch_stiffness.push_back(branch.stiffness);
      branch_viscosity.push_back(branch.viscosity);
    }
  }
  file.write(group + "/maxwell_stiffness", stiffness, "N/m");
  file.write(group + "/maxwell_viscosity", viscosity, "N s/m");
  file.write(group + "/normal_to_shear", ratio, "1");
  file.write(group + "/radius_multiplier", multiplier, "1");
  file.write(group + "/n_branches", n_branches);
  file.write(group + "/kelvin_stiffness", branch_stiffness, "N/m");
  file.write(group + "/kelvin_viscosity", branch_viscosity, "N s/m");
}

std::vector<BondLaw> read_laws(const Hdf5File& file, const std::string& group)
{
  const auto stiffness = file.read_doubles(group + "/maxwell_stiffness");
  const auto viscosity = file.read_doubles(group + "/maxwell_viscosity");
  const auto ratio = file.read_doubles(group + "/normal_to_shear");
  const auto multiplier = file.read_doubles(group + "/radius_multiplier");
  const auto n_branches = file.read_integers(group + "/n_branches");
  const auto branch_stiffness = file.read_doubles(group + "/kelvin_stiffness");
  const auto branch_viscosity = file.read_doubles(group + "/kelvin_viscosity");
  const std::size_t n = stiffness.size();
  require(viscosity.size() == n && ratio.size() == n && multiplier.size() == n &&
              n_branches.size() == n && branch_stiffness.size() == branch_viscosity.size(),
          group, "the numbers of the laws do not fit together");
  std::vector<BondLaw> laws;
  std::size_t next = 0;
  for (std::size_t l = 0; l < n; ++l) {
    CreepLaw creep{stiffness[l], {}, {}};
    if (viscosity[l] < std::numeric_limits<double>::infinity())
      creep.maxwell_viscosity = viscosity[l];
    require(n_branches[l] >= 0 && std::size_t(n_branches[l]) <= branch_stiffness.size() - next,
            group, "branches of a law are missing");
    for (std::int32_t k = 0; k < n_branches[l]; ++k, ++next)
      creep.branches.push_back({branch_stiffness[next], branch_viscosity[next]});
    laws.push_back({std::move(creep), ratio[l], multiplier[l]});
  }
  return laws;
}

Bonds read_bonds(const Hdf5File& file, const std::string& group)
{
  Bonds bonds;
  const auto ends = file.read_integers(group + "/particles");
  for (std::size_t k = 0; k + 1 < ends.size(); k += 2)
    bonds.ends.push_back({ends[k], ends[k + 1]});
  bonds.section_radius = file.read_doubles(group + "/section_radius");
  bonds.contact_offset = file.read_doubles(group + "/contact_offset");
  const auto law = file.read_integers(group + "/law");
  bonds.law.assign(law.begin(), law.end());
  bonds.id = file.read_long_integers(group + "/id");
  return bonds;
}

void check(const VolumeElement& element, const std::string& group)
{
  const std::size_t n = element.bonds.size();
  require(element.bonds.section_radius.size() == n && element.bonds.contact_offset.size() == n &&
              element.bonds.law.size() == n && element.bonds.id.size() == n &&
              element.shift.size() == n,
          group, "the columns of the bonds differ in length");
  const auto n_particles = Index(element.particles.size());
  for (const auto& ends : element.bonds.ends)
    for (const Index end : ends)
      require(end >= 0 && end < n_particles, group, "a bond ends at a particle that is not there");
  for (const int law : element.bonds.law)
    require(law >= 0 && law < std::ssize(element.laws), group,
            "a bond has a law that is not there");
  for (const BoundaryParticle& each : element.boundary)
    require(each.particle >= 0 && each.particle < n_particles, group,
            "a boundary particle is not there");
}

} // namespace

void write_volume_element(Hdf5File& file, const std::string& group, const VolumeElement& element)
{
  const Mat3& edges = element.cell.edges;
  file.write(group + "/edges", std::span(edges.data(), 9), "m", 3); // one edge per row
  write_particles(file, group + "/particles", element.particles);
  write_laws(file, group + "/laws", element.laws);
  std::vector<std::int32_t> pair_laws, ends, boundary;
  for (const PairLaw& each : element.pair_laws)
    pair_laws.insert(pair_laws.end(), {each.class_a, each.class_b, each.law});
  for (const auto& [a, b] : element.bonds.ends)
    ends.insert(ends.end(), {a, b});
  std::vector<ImageShift> sides;
  for (const auto& [particle, side] : element.boundary) {
    boundary.push_back(particle);
    sides.push_back(side);
  }
  file.write(group + "/pair_laws", pair_laws, 3);
  const std::string bonds = group + "/bonds";
  file.write(bonds + "/particles", ends, 2);
  file.write(bonds + "/image_shift", flat(element.shift), 3);
  file.write(bonds + "/section_radius", element.bonds.section_radius, "m");
  file.write(bonds + "/contact_offset", element.bonds.contact_offset, "m");
  file.write(bonds + "/law",
             std::vector<std::int32_t>(element.bonds.law.begin(), element.bonds.law.end()));
  file.write(bonds + "/id", element.bonds.id);
  file.write(group + "/boundary/particle", boundary);
  file.write(group + "/boundary/side", flat(sides), 3);
  file.set_attribute(group, "is_periodic", element.is_periodic ? 1.0 : 0.0);
}

VolumeElement read_volume_element(const Hdf5File& file, const std::string& group)
{
  const std::vector<double> edges = file.read_doubles(group + "/edges");
  require(edges.size() == 9, group, "a cell has three edges of three components");
  const auto pair_laws = file.read_integers(group + "/pair_laws");
  const auto boundary = file.read_integers(group + "/boundary/particle");
  const auto sides = shifts(file.read_integers(group + "/boundary/side"));
  require(sides.size() == boundary.size(), group, "each boundary particle needs its sides");
  VolumeElement element{{Eigen::Map<const Mat3>(edges.data())},
                        read_particles(file, group + "/particles"),
                        read_laws(file, group + "/laws"),
                        {},
                        read_bonds(file, group + "/bonds"),
                        shifts(file.read_integers(group + "/bonds/image_shift")),
                        file.number_attribute(group, "is_periodic") != 0,
                        {}};
  for (std::size_t k = 0; k + 2 < pair_laws.size(); k += 3)
    element.pair_laws.push_back({pair_laws[k], pair_laws[k + 1], pair_laws[k + 2]});
  for (std::size_t k = 0; k < boundary.size(); ++k)
    element.boundary.push_back({boundary[k], sides[k]});
  check(element, group);
  return element;
}

} // namespace dem
