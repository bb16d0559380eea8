#include "apps/specimen.h"
#include "dem/soft_spheres.h"

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace apps {

namespace {

std::string met(bool condition)
{
  return condition ? "" : "   NOT MET";
}

/// Bonds that the scene would make, for the fabric.
dem::ContactPairs bonded_pairs(const Scene& scene, const dem::Particles& particles)
{
  const Scene::Specimen& v = scene.specimen;
  return v.bond_rule == BondRule::gap ? dem::contacts_within(particles, v.bond_gap)
                                      : dem::nearest_contacts(particles, v.mean_contacts);
}

/// Mean dyadic of the contact normals; its trace is 1.
dem::Mat3 fabric(const dem::Particles& particles, const dem::ContactPairs& pairs)
{
  dem::Mat3 sum = dem::Mat3::Zero();
  for (const auto& [a, b] : pairs.pairs) {
    const dem::Vec3 n = (particles.centre[b] - particles.centre[a]).normalized();
    sum += n * n.transpose();
  }
  return pairs.pairs.empty() ? sum : dem::Mat3(sum / double(pairs.pairs.size()));
}

std::string grading_rows(const dem::PackingRequest& request, const dem::Particles& particles)
{
  std::vector<double> diameter;
  for (const double r : particles.radius)
    diameter.push_back(2 * r);
  const std::vector<double> found = dem::passing(diameter, request.grading.sieves);
  std::string rows = "  grading, mass passing          asked      got\n";
  for (std::size_t k = 0; k < found.size(); ++k)
    rows += fmt::format("    {:>6.1f} mm                  {:>6.1f} %  {:>6.1f} %\n",
                        1e3 * request.grading.sieves[k].opening,
                        100 * request.grading.sieves[k].passing, 100 * found[k]);
  return rows;
}

} // namespace

std::string packing_report(const Scene& scene, const Packing& packing)
{
  const dem::PackingRequest request = packing_request(scene);
  const dem::Particles& particles = packing.particles;
  const double n = double(particles.size());
  const dem::SoftSpheres spheres{request.container, particles.centre, particles.radius};
  dem::NearSpheres near = dem::make_near_spheres(spheres);
  double solid = 0;
  for (const double r : particles.radius)
    solid += dem::sphere_volume(r);
  const double fraction = solid / request.container.volume();
  const std::vector<double> missing =
      dem::gaps_to_neighbour(spheres, near, std::max(1, request.min_contacts));
  long n_short = 0;
  for (std::size_t i = 0; request.min_contacts > 0 && i < missing.size(); ++i)
    n_short += missing[i] > request.contact_gap * particles.radius[i];
  const double stress = request.preparation_stiffness * dem::compression(spheres, near).virial /
                        (3 * request.container.volume());
  const dem::ContactPairs touching = dem::contacts_within(particles, request.contact_gap);
  const dem::ContactPairs bonded = bonded_pairs(scene, particles);
  const double mean_touching = 2 * double(touching.pairs.size()) / n;
  const double mean_bonded = 2 * double(bonded.pairs.size()) / n;
  const dem::Mat3 tensor = fabric(particles, bonded);
  const Eigen::SelfAdjointEigenSolver<dem::Mat3> axes(tensor);

  std::string text = fmt::format("Packing ({})\n", packing.origin);
  text += fmt::format("  particles                      {}\n", particles.size());
  text += fmt::format("  diameters                      {:.2f} to {:.2f} mm\n",
                      2e3 * std::ranges::min(particles.radius),
                      2e3 * std::ranges::max(particles.radius));
  text +=
      fmt::format("  solid fraction                 {:.4f}, asked {:g}{}\n", fraction,
                  request.solid_fraction, met(std::abs(fraction - request.solid_fraction) < 0.002));
  text +=
      fmt::format("  residual isotropic stress      {:.3g} kPa, bound {:g} kPa{}\n", stress / 1e3,
                  request.residual_stress_bound / 1e3, met(stress < request.residual_stress_bound));
  text += fmt::format("  particles under {} contacts     {}, asked 0{}\n", request.min_contacts,
                      n_short, met(n_short == 0));
  text += fmt::format("  mean contact number            {:.2f} touching (gap < {:g} radii)\n",
                      mean_touching, request.contact_gap);
  text += fmt::format("  bonds                          {}, {:.2f} at each particle",
                      bonded.pairs.size(), mean_bonded);
  if (scene.specimen.bond_rule == BondRule::mean_contacts)
    text +=
        fmt::format(" (gap < {:.2g} radii), asked {:g}{}", bonded.gap, scene.specimen.mean_contacts,
                    met(std::abs(mean_bonded - scene.specimen.mean_contacts) < 0.01));
  text += fmt::format("\n  fabric xx, yy, zz              {:.3f}, {:.3f}, {:.3f} "
                      "(1/3 is isotropic; largest - smallest {:.3f})\n",
                      tensor(0, 0), tensor(1, 1), tensor(2, 2),
                      axes.eigenvalues()[2] - axes.eigenvalues()[0]);
  return text + grading_rows(request, particles);
}

} // namespace apps
